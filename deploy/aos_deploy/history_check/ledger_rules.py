"""The rules for the ledgers of middleware and adapters, against the journal's intentions."""

from collections.abc import Mapping
from typing import Any

from aos_deploy.history_check.journal_rules import Found, JournalRules, digest
from aos_protocol.messages import Activate, ActivationId, Outcome, SkillCall, SkillResult
from aos_runtime.disk.journal import JournalRow
from aos_runtime.disk.ledger import Failure
from aos_runtime.parties.fence import meaning

MIDDLEWARE_KINDS: dict[str, type[Any]] = {"started": Activate, "ended": Outcome}
ADAPTER_KINDS: dict[str, type[Any]] = {"started": SkillCall, "ended": SkillResult, "failed": Failure}


class Motions:
    """The calls that were started in any ledger of an adapter, with the file and row of each."""

    def __init__(self) -> None:
        self._first: dict[ActivationId, tuple[str, int]] = {}

    def start(self, id: ActivationId, file: str, row: int, found: Found) -> None:
        """One motion; a second one of an id is told to `found`."""
        if id in self._first:
            first_file, first_row = self._first[id]
            found("motion", f"{id} moved before, by row {first_row} of {first_file}")
        else:
            self._first[id] = (file, row)


class LedgerRules:
    """Takes the rows of one ledger in their order.

    `journals` are those of the missions, by their names. An id of any other mission is that of a call by
    hand: it moves at most once, too, but nobody has intended it. With `motions` the ledger is an adapter's:
    what it starts moves something.
    """

    def __init__(
        self, file: str, journals: Mapping[str, JournalRules], motions: Motions | None = None
    ) -> None:
        self._file = file
        self._journals = journals
        self._motions = motions
        self._epochs: dict[str, int] = {}
        self._started: set[ActivationId] = set()
        self.ended: set[ActivationId] = set()

    def take(self, row: JournalRow, message: Any, found: Found) -> None:
        """One row with its message; what is wrong is told to `found`."""
        if isinstance(message, Activate | SkillCall):
            self._take_start(row, message, found)
        else:
            self._take_end(message, found)

    def _take_start(self, row: JournalRow, request: Activate | SkillCall, found: Found) -> None:
        id = request.id
        if request.epoch < self._epochs.get(id.mission, 0):
            found("epochs", f"epoch {request.epoch} after epoch {self._epochs[id.mission]}")
        self._epochs[id.mission] = max(request.epoch, self._epochs.get(id.mission, 0))
        self._started.add(id)
        if self._motions is not None:
            self._motions.start(id, self._file, row.seq, found)
        if (journal := self._journals.get(id.mission)) is not None:
            self._check_intended(row, request, journal, found)

    @staticmethod
    def _check_intended(
        row: JournalRow, request: Activate | SkillCall, journal: JournalRules, found: Found
    ) -> None:
        intention = journal.intentions.get(request.id)
        if intention is None:
            found("id", f"{request.id} was not intended")
        elif _meaning_of_action(request) != intention.meaning:
            found("id", f"{request.id} stands for another skill or other parameters in the journal")
        if journal.was_holding(row.stamp_ns):
            found("hold", f"{request.id} starts while the mission holds")
        if journal.end_ns is not None and row.stamp_ns > journal.end_ns:
            found("over", f"{request.id} starts after the mission's end")

    def _take_end(self, end: Outcome | SkillResult | Failure, found: Found) -> None:
        if end.id not in self._started:
            found("ends", f"{end.id} ends, and was not started")
        if end.id in self.ended:
            found("ends", f"{end.id} ends for the second time")
        self.ended.add(end.id)
        journal = self._journals.get(end.id.mission)
        intention = journal.intentions.get(end.id) if journal is not None else None
        if not isinstance(end, Outcome) or intention is None:
            return
        if intention.outcome not in (None, digest(end)):
            found("outcome", f"the journal has another outcome of {end.id}")


def _meaning_of_action(request: Activate | SkillCall) -> str:
    """The meaning as an intention has it; a call has fields besides, made of the action by its mapping."""
    if isinstance(request, Activate):
        return meaning(request)
    return meaning(Activate(request.id, request.skill, request.parameters, request.deadline_s))
