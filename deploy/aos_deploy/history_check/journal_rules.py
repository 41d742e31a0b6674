"""The rules for a mission's journal: one pass over its rows."""

import hashlib
from collections.abc import Callable
from typing import Any, NamedTuple

import msgspec

from aos_deploy.runs.end import Account
from aos_protocol import messages
from aos_protocol.messages import ActionRefused, DecisionRecord, MissionState, Steer
from aos_protocol.mission_rows import DRIFT, MESSAGES
from aos_runtime.disk.journal import JournalRow
from aos_runtime.parties.fence import meaning
from aos_solver.mission.control.steering import Asked, Steering

KINDS = {kind: message for kind, message in MESSAGES.items() if kind != DRIFT}
"""The kinds of rows that the rules are about."""

Found = Callable[[str, str], None]
"""Takes a rule and what is wrong with the row that is looked at."""


class Intention(NamedTuple):
    """The meaning of an id; the digest of its outcome once it is there, and the row where it was observed."""

    meaning: str
    outcome: bytes | None = None
    observed_row: int = 0


class JournalRules:
    """Takes the journal's rows in their order. `mission` is the name that all of them have.

    For the ledgers it keeps the `intentions` by id, and by the clock of the machine the mission's end and the
    times during which it held.
    """

    def __init__(self, run: str) -> None:
        self.mission = run
        self.account = Account()
        self.intentions: dict[messages.ActivationId, Intention] = {}
        self.end_ns: int | None = None
        self._holds: list[tuple[int, int]] = []
        self._held_since_ns: int | None = None
        self._sequence = 0
        self._step = 0
        self._epoch = 0
        self._pending: messages.DecisionRecord | None = None
        self._open: messages.Activate | None = None
        self._outcome: messages.Outcome | None = None
        self._belief: tuple[str, messages.BeliefSummary] | None = None
        self._is_handed_over = False
        self._steering = SteeringRules()

    def was_holding(self, stamp_ns: int) -> bool:
        """Says whether the mission held at this time."""
        is_after = self._held_since_ns is not None and stamp_ns > self._held_since_ns
        return is_after or any(begin_ns < stamp_ns < end_ns for begin_ns, end_ns in self._holds)

    def take(self, row: JournalRow, message: Any, found: Found) -> None:
        """One row with its message, which is of one of KINDS; what is wrong is told to `found`."""
        if self.end_ns is not None and not _is_end(message):
            found("over", f"a row of the kind {row.kind} after the mission's end")
        self._steering.take(message, found)
        if isinstance(message, messages.Steer | messages.ActionRefused):
            return
        if isinstance(message, messages.MissionState):
            self._take_state(row, message, found)
            return
        if isinstance(message, messages.MissionBegun | messages.ModelAdopted):
            self._take_model(message, found)
            return
        if self._held_since_ns is not None and not isinstance(message, messages.Outcome):
            found("hold", f"a row of the kind {row.kind} while the mission holds")
        if isinstance(message, messages.Activate):
            self._take_intention(message, found)
        elif isinstance(message, messages.Outcome):
            self._take_outcome(row, message, found)
        elif message.outcome is None:
            self._take_decision(message, found)
        else:
            self._take_observation(message, found)

    def _take_state(self, row: JournalRow, state: messages.MissionState, found: Found) -> None:
        self._check_epoch(state.epoch, found)
        self.account.take(state)
        if self._held_since_ns is not None:
            self._holds.append((self._held_since_ns, row.stamp_ns))
        self._held_since_ns = row.stamp_ns if state.phase == "holding" else None
        if _is_end(state) and self.end_ns is None:
            self.end_ns = row.stamp_ns

    def _take_model(self, message: messages.MissionBegun | messages.ModelAdopted, found: Found) -> None:
        """A belief that was handed over from another model is not that which a new solver replays."""
        if isinstance(message, messages.ModelAdopted):
            self._is_handed_over |= message.by != "replay"
            return
        if message.epoch != self._epoch + 1:
            found("epochs", f"a solver begins with epoch {message.epoch} after epoch {self._epoch}")
        self._epoch = max(message.epoch, self._epoch)
        if self._is_handed_over:
            self._belief, self._is_handed_over = None, False

    def _take_record(self, record: messages.DecisionRecord, found: Found) -> None:
        self._check_epoch(record.epoch, found)
        if record.sequence != self._sequence:
            found("sequence", f"the record {record.sequence} in place of {self._sequence}")
        if record.mission != self.mission and self._sequence > 0:
            found("steps", f"a record of the mission {record.mission}, not of {self.mission}")
        self.mission = record.mission
        self._sequence = record.sequence + 1
        self.account.take(record)

    def _take_decision(self, decision: messages.DecisionRecord, found: Found) -> None:
        self._take_record(decision, found)
        if self._pending is not None:
            found("steps", f"step {decision.step} is decided before step {self._pending.step} is observed")
        elif decision.step != self._step + 1:
            found("steps", f"step {decision.step} follows step {self._step}")
        # Another model has another belief: its hand-over is no matter of the history. A new solver replaces
        # particles that no replay gives.
        digest, belief = self._belief or ("", None)
        is_repeated = belief is not None and not belief.digest and bool(decision.belief.digest)
        if digest == decision.model_digest and decision.belief != belief and not is_repeated:
            found("belief", f"step {decision.step} is decided with another belief than was observed")
        self._step, self._pending, self._open, self._outcome = decision.step, decision, None, None

    def _take_observation(self, record: messages.DecisionRecord, found: Found) -> None:
        self._take_record(record, found)
        pending = self._pending
        if pending is None or _decided(record) != _decided(pending):
            found("steps", f"what is observed at step {record.step} was not decided before it")
        if self._outcome is None or record.outcome != self._outcome:
            found("outcome", f"the record of step {record.step} has another outcome than the row before it")
        self._belief = (record.model_digest, record.belief)
        self._step, self._pending, self._outcome = record.step, None, None

    def _take_intention(self, intended: messages.Activate, found: Found) -> None:
        self._check_epoch(intended.epoch, found)
        pending = self._pending
        if pending is None or _wanted(intended) != (pending.mission, *_decided(pending)[:3]):
            found("intention", f"{intended.skill} of {intended.id} is not what was decided before it")
        known = self.intentions.setdefault(intended.id, Intention(meaning(intended)))
        if known.meaning != meaning(intended):
            found("id", f"{intended.id} stood for another skill or other parameters before")
        self._open = intended

    def _take_outcome(self, row: JournalRow, outcome: messages.Outcome, found: Found) -> None:
        open = self._open
        if open is None or (outcome.id, outcome.skill) != (open.id, open.skill):
            found(
                "outcome", f"the outcome of {outcome.skill} of {outcome.id} belongs to no intention before it"
            )
        else:
            known = self.intentions[open.id]
            if known.outcome not in (None, digest(outcome)):
                found("outcome", f"{outcome.id} has two different outcomes")
            observed_row = row.seq if outcome.status == "observed" else 0
            self.intentions[open.id] = known._replace(outcome=digest(outcome), observed_row=observed_row)
        self._open, self._outcome = None, outcome

    def _check_epoch(self, epoch: int, found: Found) -> None:
        if epoch < self._epoch:
            found("epochs", f"epoch {epoch} after epoch {self._epoch}")
        self._epoch = max(epoch, self._epoch)


def digest(outcome: messages.Outcome) -> bytes:
    """A short form of an outcome that tells it from others."""
    return hashlib.blake2b(msgspec.json.encode(outcome, order="deterministic"), digest_size=16).digest()


def _is_end(message: Any) -> bool:
    return isinstance(message, messages.MissionState) and message.phase == "ended"


def _decided(record: messages.DecisionRecord) -> tuple[int, str, dict[str, Any], str]:
    return record.step, record.skill, record.parameters, record.action


def _wanted(intended: messages.Activate) -> tuple[str, int, str, dict[str, Any]]:
    return intended.id.mission, intended.id.step, intended.skill, intended.parameters


_RULE = "steering"


class SteeringRules:
    """Takes the journal's rows in their order."""

    def __init__(self) -> None:
        self._steering = Steering()
        self._is_holding = False

    def take(self, message: Any, found: Callable[[str, str], None]) -> None:
        """One row's message; what is wrong is told to `found`."""
        if isinstance(message, MissionState):
            self._is_holding = message.phase == "holding"
        elif isinstance(message, Steer):
            self._steering = self._steering.after(message, is_holding=self._is_holding)
        elif isinstance(message, ActionRefused):
            if not self._steering.is_queued(message.request):
                found(_RULE, f"{message.action} is refused, and nobody has asked for it")
            self._steering = self._steering.refused(message)
        elif isinstance(message, DecisionRecord) and message.outcome is None:
            self._check(message, found)
            self._steering = self._steering.decided(message)
        elif isinstance(message, DecisionRecord):
            self._steering = self._steering.observed(message)

    def _check(self, decision: DecisionRecord, found: Callable[[str, str], None]) -> None:
        now, step = self._steering, f"step {decision.step}"
        asked = now.queue[0] if now.queue else None
        if decision.chosen_by in ("operator", "script"):
            if asked is None or (asked.action, _chosen_by(asked)) != (decision.action, decision.chosen_by):
                found(_RULE, f"{step}: nobody has asked for {decision.action}")
        elif asked is not None:
            found(_RULE, f"{step} is decided before {asked.action}, which {asked.by} has asked for")
        elif now.waits:
            found(_RULE, f"{step} is decided while {now.held_by} holds the mission")
        for name in {decision.skill, decision.action} & now.left_out.keys():
            found(_RULE, f"{step} is decided for {name}, which {now.left_out[name]} has left out")


def _chosen_by(asked: Asked) -> str:
    return "script" if asked.is_script else "operator"
