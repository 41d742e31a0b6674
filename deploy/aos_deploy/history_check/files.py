"""The files of a run for the check of its history."""

from collections.abc import Iterator
from pathlib import Path

import msgspec

from aos_deploy.history_check.check import JOURNAL, MIDDLEWARE, Checked, History, check_histories
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.summary import Summary
from aos_deploy.runs.verdict import Verdict
from aos_runtime.disk.journal import Journal, JournalRow
from aos_runtime.disk.mission_folders import mission_folders, mission_name, stays


def check_run(run: Path) -> Checked:
    """Checks the files of a run that is over; a file that cannot be read is a violation."""
    middleware = _rows(run / MIDDLEWARE) if (run / MIDDLEWARE).exists() else None
    adapters = {path.name: _rows(path) for path in run.glob("adapter-*.db")}
    return check_histories(_histories(run), middleware, adapters)


def _histories(run: Path) -> list[History]:
    directory = RunDirectory(run)
    if not stays(run):
        return [_history(run.resolve().name, run / JOURNAL, JOURNAL, directory.read_summary())]
    return [
        _history(
            mission_name(run.resolve(), number),
            folder / JOURNAL,
            str((folder / JOURNAL).relative_to(run)),
            directory.read_summary(number),
        )
        for number, folder in mission_folders(run).items()
    ]


def _history(mission: str, journal: Path, file: str, summary: Summary | None) -> History:
    verdict = msgspec.convert(summary, Verdict, from_attributes=True) if summary is not None else None
    return History(mission, _rows(journal), verdict, file)


def _rows(path: Path) -> Iterator[JournalRow]:
    with Journal.read(path) as journal:
        yield from journal.walk()
