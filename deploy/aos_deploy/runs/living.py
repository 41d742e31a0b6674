"""The missions that run on this machine, whatever folder they were started in, and the one a command means.

A run is noted while it lasts, in $AOS_RUNNING_DIR or `running` in the cache directory. What is noted there
and does not run was killed.
"""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import typer

from aos_deploy.export.run_bundle import opened_bundle
from aos_deploy.places import running_folder
from aos_deploy.printing import from_here
from aos_deploy.runs.directory import LATEST, RunDirectory
from aos_deploy.runs.end import ending_without_summary
from aos_protocol.errors import BusError, DeployError

RUNS = Path("runs")
_SHOWN_RUNS = 3
"""Commands look for run directories here unless told otherwise, or in `runs_here`."""


@contextmanager
def noted(run: RunDirectory) -> Iterator[None]:
    """Others find the run until the block ends, unless the cache directory cannot be written."""
    link = running_folder() / f"{run.path.name}-{os.getpid()}"
    with suppress(OSError):
        running_folder().mkdir(parents=True, exist_ok=True)
        link.symlink_to(run.path)
    try:
        yield
    finally:
        with suppress(OSError):
            link.unlink()


def living_runs() -> list[RunDirectory]:
    """The runs that go on, each once, the oldest first; notes of others are removed.

    A run whose aos-up was killed and that was taken up has two notes.
    """
    found: dict[Path, RunDirectory] = {}
    notes = sorted(running_folder().iterdir()) if running_folder().is_dir() else []
    for link in (note for note in notes if note.is_symlink()):
        run = RunDirectory(link.resolve())
        if run.is_running:
            found[run.path] = run
        elif not (link.exists() and run.is_held):
            link.unlink(missing_ok=True)
    return list(found.values())


def runs_here() -> Path:
    """The folder of runs that commands mean here: `runs`, or where that is none the only one a folder below.

    Runs of `deploy/robot.yaml` are in `deploy/runs`, unless the file says something else.
    """
    below = [] if RUNS.is_dir() else [latest.parent for latest in Path().glob(f"*/{RUNS}/{LATEST}")]
    return below[0] if len(below) == 1 else RUNS


def chosen_run(run: Path | None, runs: Path | None) -> RunDirectory:
    """The run that a command means: the one named, else the one that goes on, else the last one.

    What is named may also be a file of runs, as `aos export --format bundle` writes one, with one run.
    `runs` is the folder to look in; without one `runs` here comes first, then whatever goes on anywhere,
    which is told.
    DeployError AOS901 if that is not one alone, or the one named is none; BusError AOS605 if there is none.
    """
    if run is not None:
        named = RunDirectory(_opened(run) if run.is_file() else run, run)
        named.read_record()
        return named
    here, elsewhere = _living(runs)
    candidates = here or elsewhere
    has_last = (runs or RUNS).joinpath(LATEST).exists()
    if len(candidates) > 1 and (here or not has_last):
        raise _several(candidates)
    if len(candidates) != 1:
        return RunDirectory.latest(runs or runs_here())
    if elsewhere == candidates and elsewhere[0].path.parent != runs_here().resolve():
        typer.echo(f"aos: the run is {elsewhere[0].path}", err=True)
    return candidates[0]


def chosen_runs(named: Iterable[Path] | None, runs: Path | None) -> list[Path]:
    """The directories of the runs that a command means, each once; errors as from `chosen_run`.

    A folder of runs names all of them. `runs/*` names the last run twice, since `runs/latest` points to it.
    """
    found: dict[Path, Path] = {}
    each: list[Path] = [run for name in named or () for run in _runs_in(name) or [name]]
    for run in each or (None,):
        path = chosen_run(run, runs).path
        found.setdefault(path.resolve(), path)
    return list(found.values())


def _runs_in(folder: Path) -> list[Path]:
    """The runs in a folder of runs, the oldest first; none if it is no such folder."""
    if not folder.is_dir() or (folder / "run.json").exists():
        return []
    return sorted(
        path for path in folder.iterdir() if not path.is_symlink() and (path / "run.json").is_file()
    )


def living_run(run: Path | None, runs: Path | None) -> RunDirectory:
    """The same of those that go on alone; BusError AOS605 if the last one is over."""
    here, elsewhere = _living(runs)
    if run is None and len(here or elsewhere) > 1:
        raise _several(here or elsewhere)
    chosen = chosen_run(run, runs)
    if not chosen.is_running:
        hint = "Start a system with aos-up, or name a running one with --run or --connect"
        end = "is over"
        if chosen.read_summary() is None:
            is_begun = ending_without_summary(chosen.path) != "not_started"
            end = "was killed" if is_begun else "was killed before its mission began"
            hint = f"`aos-up --resume {from_here(chosen.path)}` takes it up. {hint}"
        raise BusError(f"the last run, {chosen.path.name}, {end}", code="AOS605", hint=hint)
    return chosen


def living_system(name: str, runs: Path | None) -> RunDirectory:
    """The run that goes on of a robot or a deploy file.

    `runs` is as in `chosen_run`. DeployError AOS901 if there are several, BusError AOS605 if there is none.
    """
    here, elsewhere = ([run for run in each if _is_named(run, name)] for each in _living(runs))
    named = here or elsewhere
    if len(named) > 1:
        raise _several(named)
    if not named:
        hint = "`aos runs --running` lists those that run"
        raise BusError(f"no system that runs is named {name}", code="AOS605", hint=hint)
    return named[0]


def _is_named(run: RunDirectory, name: str) -> bool:
    record = run.read_record()
    return name == record.robot or Path(name).resolve() == Path(record.deploy_file)


def _opened(file: Path) -> Path:
    """The directory of the run in a file, unpacked."""
    runs = opened_bundle(file)
    if len(runs) > 1:
        shown = ", ".join(run.name for run in runs[-_SHOWN_RUNS:])
        hint = f"Name one in {runs[0].parent}. The newest there: {shown}"
        raise DeployError(f"{file} has {len(runs)} runs", code="AOS901", hint=hint)
    return runs[0]


def _living(runs: Path | None) -> tuple[list[RunDirectory], list[RunDirectory]]:
    """The runs that go on in a folder, by default in ./runs, and those elsewhere if no folder is named."""
    going_on = living_runs()
    here = [run for run in going_on if run.path.parent == (runs or RUNS).resolve()]
    return here, [run for run in going_on if run not in here] if runs is None else []


def _several(runs: list[RunDirectory]) -> DeployError:
    names = ", ".join(str(run.path) for run in runs)
    return DeployError(f"{len(runs)} systems run: {names}", code="AOS901", hint="Name one with --run")
