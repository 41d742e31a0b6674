"""The whole check: every row of a run against every rule, and the rules by name."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple, Protocol

import msgspec

from aos_deploy.history_check.journal_rules import KINDS, Found, JournalRules
from aos_deploy.history_check.ledger_rules import ADAPTER_KINDS, MIDDLEWARE_KINDS, LedgerRules, Motions
from aos_deploy.runs.end import Verdict
from aos_protocol.errors import StorageError
from aos_runtime.disk.journal import JournalError, JournalRow
from aos_runtime.disk.mission_folders import JOURNAL

RULES = {
    "rows": "the rows of each file are numbered from 1 without a gap, and each can be read",
    "sequence": "the sequence numbers of the decision records count from 0 without a gap",
    "steps": "decisions and observations take turns, of the same action, and steps count from 1",
    "belief": "a decision is made with the belief of the observed record before it",
    "replay": "a replay of the outcomes gives each belief again, by its digest",
    "epochs": "the epoch of a mission goes up by one with each solver, and never falls",
    "intention": "an intention is that of the decision before it",
    "outcome": "an outcome belongs to the intention before it, and is the one that the middleware has stored",
    "id": "an id stands for one skill with its parameters, and nothing moves that was not intended",
    "motion": "an id moves at most once",
    "ends": "what ends was started before, and ends once",
    "hold": "nothing starts while the mission holds",
    "steering": "while somebody holds the mission nothing is decided but what was asked for, and nothing is "
    "decided for that is left out",
    "over": "nothing follows the end of the mission",
    "verdict": "the summary has the verdict of the journal, as far as that goes",
}
"""Each rule by its name."""
BY_TIME = ("hold", "over")
"""The rules by which times of a ledger are compared with those of a journal."""


class Violation(msgspec.Struct, frozen=True):
    """A row that breaks a rule: `file` is its name in the run directory, `row` its number, 0 for the file."""

    rule: str
    file: str
    row: int
    text: str


SET_BACK_NS = 10_000_000
"""Times of one file that go back by less say nothing of the clock."""
MIDDLEWARE = "middleware.db"


class _Takes(Protocol):
    def take(self, row: JournalRow, message: Any, found: Found) -> None: ...


class History(NamedTuple):
    """The rows of a mission's journal, with the file that they are of, and the verdict of its summary."""

    mission: str
    journal: Iterable[JournalRow]
    summary: Verdict | None = None
    file: str = JOURNAL


class Checked(NamedTuple):
    """The violations of all rules, in the order of the files and their rows; empty where all of them hold.

    `set_back_ns` is by how much the machine's clock was set back at most while the rows were written. Where
    it was, times of the ledgers are not held against those of the journals.
    """

    violations: list[Violation]
    set_back_ns: int = 0


class _Clock:
    """The times of rows in the order of their files."""

    def __init__(self) -> None:
        self.set_back_ns = 0

    def followed(self, rows: Iterable[JournalRow]) -> Iterator[JournalRow]:
        """The rows of one file; what their times go back is noted."""
        before_ns: int | None = None
        for row in rows:
            if before_ns is not None:
                self.set_back_ns = max(self.set_back_ns, before_ns - row.stamp_ns)
            before_ns = row.stamp_ns
            yield row

    @property
    def was_set_back(self) -> bool:
        return self.set_back_ns > SET_BACK_NS


def check_histories(
    histories: Iterable[History],
    middleware: Iterable[JournalRow] | None = None,
    adapters: Mapping[str, Iterable[JournalRow]] | None = None,
) -> Checked:
    """Holds every row against every rule.

    `middleware` are the rows of its ledger, `adapters` those of each adapter by the name of the file, as far
    as they are on this machine.
    """
    found: list[Violation] = []
    clock = _Clock()
    histories = list(histories)
    read = []
    for history in histories:
        rules = JournalRules(history.mission)
        _go_through(history.file, clock.followed(history.journal), KINDS, rules, found)
        read.append(rules)
    journals = {rules.mission: rules for rules in read}
    if middleware is not None:
        ledger = LedgerRules(MIDDLEWARE, journals)
        _go_through(MIDDLEWARE, clock.followed(middleware), MIDDLEWARE_KINDS, ledger, found)
        for history, rules in zip(histories, read, strict=True):
            for id, intention in rules.intentions.items():
                if intention.observed_row and id not in ledger.ended:
                    text = f"the middleware has no outcome of {id}"
                    found.append(Violation("outcome", history.file, intention.observed_row, text))
    motions = Motions()
    for file, rows in sorted((adapters or {}).items()):
        ledger = LedgerRules(file, journals, motions)
        _go_through(file, clock.followed(rows), ADAPTER_KINDS, ledger, found)
    for history, rules in zip(histories, read, strict=True):
        if history.summary is not None:
            _check_summary(history, history.summary, rules, found)
    if not clock.was_set_back:
        return Checked(found)
    of_journals = {history.file for history in histories}
    kept = [each for each in found if each.rule not in BY_TIME or each.file in of_journals]
    return Checked(kept, clock.set_back_ns)


def _check_summary(history: History, summary: Verdict, rules: JournalRules, found: list[Violation]) -> None:
    verdict = rules.account.verdict()
    # A journal that had no space for its end, or was damaged, tells less.
    alone = () if verdict.ending else ("ending", "remark", "exit_code")
    differing = [
        name
        for name in summary.__struct_fields__
        if name not in alone and getattr(summary, name) != getattr(verdict, name)
    ]
    if differing:
        file = history.file.replace(JOURNAL, "summary.json")
        found.append(Violation("verdict", file, 0, f"it differs in {', '.join(differing)}"))


def _go_through(
    file: str,
    rows: Iterable[JournalRow],
    kinds: Mapping[str, type[Any]],
    rules: _Takes,
    violations: list[Violation],
) -> None:
    """Takes the rows of one file; a row of a kind that no rule is about is only counted."""
    number = 0

    def found(rule: str, text: str) -> None:
        violations.append(Violation(rule, file, number, text))

    try:
        for row in rows:
            before, number = number, row.seq
            if number != before + 1:
                found("rows", f"row {number} follows row {before}")
            kind = kinds.get(row.kind)
            if kind is None:
                continue
            try:
                message = row.read_as(kind)
            except StorageError as error:
                found("rows", _without_file(error))
            else:
                rules.take(row, message, found)
    except StorageError as error:
        found("rows", f"nothing can be read after it: {_without_file(error)}")


def _without_file(error: StorageError) -> str:
    """The fault of a file, whose name each violation has already."""
    return error.what if isinstance(error, JournalError) else str(error)
