"""The whole check: every row of a run against every rule."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Protocol

import msgspec

from aos_deploy.history_check.journal_rules import KINDS, Found, JournalRules
from aos_deploy.history_check.ledger_rules import ADAPTER_KINDS, MIDDLEWARE_KINDS, LedgerRules, Motions
from aos_deploy.history_check.rules import Violation
from aos_deploy.verdict import Verdict
from aos_protocol.errors import StorageError
from aos_runtime.journal import JournalRow

__all__ = ["violations"]

JOURNAL, MIDDLEWARE = "journal.db", "middleware.db"


class _Takes(Protocol):
    def take(self, row: JournalRow, message: Any, found: Found) -> None: ...


def violations(
    run: str,
    journal: Iterable[JournalRow],
    middleware: Iterable[JournalRow] | None = None,
    adapters: Mapping[str, Iterable[JournalRow]] | None = None,
    summary: Verdict | None = None,
) -> list[Violation]:
    """The violations of all rules, in the order of the files and their rows; empty where all of them hold.

    `run` is its name. `middleware` are the rows of its ledger, `adapters` those of each
    adapter's by the name of the file, as far as they are on this machine. `summary` is the verdict that
    summary.json has.
    """
    found: list[Violation] = []
    rules = JournalRules(run)
    _go_through(JOURNAL, journal, KINDS, rules, found)
    if middleware is not None:
        ledger = LedgerRules(MIDDLEWARE, rules)
        _go_through(MIDDLEWARE, middleware, MIDDLEWARE_KINDS, ledger, found)
        for id, intention in rules.intentions.items():
            if intention.observed_row and id not in ledger.ended:
                text = f"the middleware has no outcome of {id}"
                found.append(Violation("outcome", JOURNAL, intention.observed_row, text))
    motions = Motions()
    for file, rows in sorted((adapters or {}).items()):
        _go_through(file, rows, ADAPTER_KINDS, LedgerRules(file, rules, motions), found)
    if summary is not None and summary != (verdict := rules.account.verdict()):
        differing = [
            name for name in summary.__struct_fields__ if getattr(summary, name) != getattr(verdict, name)
        ]
        found.append(Violation("verdict", "summary.json", 0, f"it differs in {', '.join(differing)}"))
    return found


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
                message = msgspec.json.decode(row.payload, type=kind)
            except msgspec.MsgspecError as error:
                found("rows", f"it cannot be read: {error}")
            else:
                rules.take(row, message, found)
    except StorageError as error:
        found("rows", f"nothing can be read after it: {error}")
