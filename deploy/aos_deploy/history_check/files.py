"""The files of a run for the check of its history."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import msgspec

from aos_deploy.history_check.check import JOURNAL, MIDDLEWARE, violations
from aos_deploy.history_check.rules import Violation
from aos_deploy.run_directory import RunDirectory
from aos_deploy.verdict import Verdict
from aos_runtime.journal import Journal, JournalRow

__all__ = ["violations_of_run"]


def violations_of_run(run: Path) -> list[Violation]:
    """Returns the violations in the files of a run that is over; a file that cannot be read is one."""
    summary = RunDirectory(run).read_summary()
    return violations(
        run.resolve().name,
        _rows(run / JOURNAL),
        _rows(run / MIDDLEWARE) if (run / MIDDLEWARE).exists() else None,
        {path.name: _rows(path) for path in run.glob("adapter-*.db")},
        msgspec.convert(summary, Verdict, from_attributes=True) if summary is not None else None,
    )


def _rows(path: Path) -> Iterator[JournalRow]:
    with Journal.read(path) as journal:
        yield from journal.walk()
