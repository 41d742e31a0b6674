"""`aos runs`: the missions that run on this machine, and those that are kept in a folder."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from aos_deploy.options import AsJson
from aos_deploy.printing import count, from_here, print_json
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.end import beginning_of, ending_without_summary
from aos_deploy.runs.living import living_runs, runs_here
from aos_deploy.runs.pruning import Pruned, pruned
from aos_deploy.runs.record import RunRecord, Summary
from aos_protocol.errors import DeployError
from aos_runtime.disk.mission_folders import mission_folder, mission_folders

runs_app = typer.Typer(name="runs", epilog="Example: aos runs --running")

_UNENDED = ("killed", "not_started")
_SHOWN_MISSIONS = 10
"""So many of the newest missions of a system have lines of their own."""


class Entry(msgspec.Struct, omit_defaults=True):
    """A run in the output of `aos runs --json`. `ending` is `running`, `waiting` between two missions, or
    `killed` or `not_started` where there is no other.

    A system that stays has its `missions` with it, each as an entry of its own; its steps are all of theirs.
    """

    directory: str
    robot: str
    started: str
    ending: str
    steps: int | None
    duration_s: float | None
    endpoint: str
    missions: tuple[Entry, ...] = ()
    mission_parameters: dict[str, str] = {}


Folder = Annotated[Path | None, typer.Option("--runs", metavar="DIR", help="Instead of ./runs")]


@runs_app.callback(invoke_without_command=True)
def runs(
    context: typer.Context,
    folder: Folder = None,
    running: Annotated[bool, typer.Option("--running", help="Only those that run, wherever")] = False,
    as_json: AsJson = False,
) -> None:
    """List the missions of this machine.

    Lists those that run, wherever they were started, and those kept in ./runs. `aos decisions --run DIR`
    shows one of them, `aos runs prune` removes old ones.
    """
    if context.invoked_subcommand is not None:
        context.obj = folder
        return
    going_on = {run.path: run for run in living_runs()}
    kept = {} if running else {run.path: run for run in _runs_in(folder or runs_here())}
    entries = [entry_of(run) for run in (kept | going_on).values()]
    entries.sort(key=lambda entry: entry.started)
    if as_json:
        print_json(entries)
        return
    print_entries(entries)
    if not entries:
        where = "" if running else f", and there is no run in {folder or runs_here()}"
        typer.echo(f"No mission runs{where}.")


@runs_app.command(epilog="Example: aos runs prune --keep 20")
def prune(
    context: typer.Context,
    keep: Annotated[int, typer.Option("--keep", min=0, help="How many of the newest runs stay")],
    folder: Folder = None,
    as_json: AsJson = False,
) -> None:
    """Remove all but the newest runs of ./runs.

    A run that goes on is never removed.
    """
    folder = folder or context.obj or runs_here()
    done = pruned(folder, keep) if folder.is_dir() else Pruned((), 0)
    if as_json:
        print_json({"removed": done.removed, "kept": done.kept, "freed_bytes": done.freed_bytes})
        return
    for run in done.removed:
        typer.echo(f"removed {from_here(Path(run.directory))}  {run.size_bytes / 1e6:.1f} MB")
    typer.echo(
        f"{count(len(done.removed), 'run')} removed, {done.freed_bytes / 1e6:.1f} MB freed; {done.kept} kept"
    )


def print_entries(entries: Iterable[Entry]) -> None:
    """Each on a line, those of its newest missions below it."""
    for entry in entries:
        _print_entry(entry)
        if earlier := Counter(mission.ending for mission in entry.missions[:-_SHOWN_MISSIONS]):
            endings = ", ".join(f"{number:,} {ending}" for ending, number in earlier.most_common())
            missions = count(earlier.total(), "earlier mission")
            typer.echo(f"  {missions}: {endings}. `aos runs --json` lists each")
        for mission in entry.missions[-_SHOWN_MISSIONS:]:
            _print_entry(mission)


def _print_entry(entry: Entry) -> None:
    steps = "" if entry.steps is None else count(entry.steps, "step")
    took = "" if entry.duration_s is None else f"{entry.duration_s:7.1f} s"
    values = "".join(f"  {name}={value}" for name, value in entry.mission_parameters.items())
    typer.echo(f"{entry.ending:18} {steps:>9} {took:>9}  {entry.robot}  {entry.directory}{values}")


def _runs_in(folder: Path) -> list[RunDirectory]:
    found = folder.resolve().glob("*/run.json")
    return [RunDirectory(record.parent) for record in found if not record.parent.is_symlink()]


def entry_of(run: RunDirectory) -> Entry:
    """A run as it is listed."""
    try:
        record = run.read_record()
    except DeployError:
        return Entry(str(from_here(run.path)), "", "", "unreadable", None, None, "")
    summary = run.read_summary()
    missions = tuple(_mission(run, number, record) for number in mission_folders(run.path))
    ending = summary.ending if summary else _ending_without_summary(run, missions)
    return _entry_of(run.path, record, summary, record.started, ending, missions)


def _ending_without_summary(run: RunDirectory, missions: tuple[Entry, ...]) -> str:
    if not run.is_running:
        return ending_without_summary(run.path)
    return "waiting" if missions and missions[-1].ending != "running" else "running"


def _mission(run: RunDirectory, number: int, record: RunRecord) -> Entry:
    """A mission of a system that stays."""
    folder, summary = mission_folder(run.path, number), run.read_summary(number)
    ending = summary.ending if summary else ending_without_summary(folder)
    if run.is_running and ending in _UNENDED:
        ending = "running"
    return _entry_of(folder, record, summary, summary.started if summary else "", ending)


def _entry_of(
    folder: Path,
    record: RunRecord,
    summary: Summary | None,
    started: str,
    ending: str,
    missions: tuple[Entry, ...] = (),
) -> Entry:
    begun = beginning_of(folder)  # Also of a mission that runs or was killed.
    return Entry(
        directory=str(from_here(folder)),
        robot=record.robot,
        started=started,
        ending=ending,
        steps=summary.steps if summary else None,
        duration_s=summary.duration_s if summary else None,
        endpoint=record.endpoint,
        missions=missions,
        mission_parameters=begun.mission_parameters if begun is not None else {},
    )
