"""The files of a run for the check of its history."""

from pathlib import Path

import msgspec

from aos_deploy.history_check.check import MIDDLEWARE, Checked, History, check_histories
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.end import Verdict
from aos_deploy.runs.record import Summary
from aos_runtime.disk.journal import rows_of
from aos_runtime.disk.mission_folders import journals, mission_name


def check_run(run: Path) -> Checked:
    """Checks the files of a run that is over; a file that cannot be read is a violation."""
    middleware = rows_of(run / MIDDLEWARE) if (run / MIDDLEWARE).exists() else None
    adapters = {path.name: rows_of(path) for path in run.glob("adapter-*.db")}
    return check_histories(_histories(run), middleware, adapters)


def _histories(run: Path) -> list[History]:
    directory = RunDirectory(run)
    return [
        _history(mission_name(run.resolve(), number), path, run, directory.read_summary(number))
        for number, path in journals(run).items()
    ]


def _history(mission: str, journal: Path, run: Path, summary: Summary | None) -> History:
    verdict = msgspec.convert(summary, Verdict, from_attributes=True) if summary is not None else None
    return History(mission, rows_of(journal), verdict, str(journal.relative_to(run)))
