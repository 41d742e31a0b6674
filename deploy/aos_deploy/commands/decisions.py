"""`aos decisions`: follows a mission from another terminal, or reads one that is over."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from aos_deploy.options import Mission, command
from aos_deploy.printing import from_here
from aos_deploy.running_system import System
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import chosen_run
from aos_deploy.views.lines import lines_of, on_one_line
from aos_protocol.access import WATCHER
from aos_protocol.messages import DecisionRecord, MissionState
from aos_protocol.unavailable import told_together
from aos_runtime.disk.mission_folders import JOURNAL, mission_folder, mission_folders

if TYPE_CHECKING:
    from aos_runtime.client import AosClient

Show = Callable[[DecisionRecord | MissionState], None]


_SOLVER_S = 15.0
"""The solver may have gone since its run was found."""


@command("Example: aos decisions --json | jq 'select(.outcome).action'")
def decisions(
    system: System,
    as_json: Annotated[
        bool, typer.Option("--json", help="A JSON decision record a line, once more with its outcome")
    ] = False,
    follow: Annotated[bool, typer.Option(help="Go on until the mission ends")] = True,
    mission: Mission = None,
) -> None:
    """Print every decision of a mission from its first step.

    What was chosen, by which planner and why, and what came of it.

    While the mission runs the decisions come from the bus, afterwards from the run directory's journal.
    """

    shown: set[tuple[str, int]] = set()

    def show(event: DecisionRecord | MissionState) -> None:
        if isinstance(event, DecisionRecord):
            shown.add((event.mission, event.sequence))
        if as_json:
            if isinstance(event, DecisionRecord):
                typer.echo(msgspec.json.encode(event))
        else:
            typer.echo("\n".join([*lines_of(event), *_reason(event)]))

    if not system.is_at_endpoint:
        directory = chosen_run(system.run, system.runs)
        newest = max(mission_folders(directory.path), default=0)
        if not directory.is_running or mission not in (None, newest):
            if mission is not None and mission not in mission_folders(directory.path):
                from aos_deploy.runs.studied import no_such_mission

                raise no_such_mission(directory.path, mission)
            number = mission or newest
            has_ended = False
            for event in _journaled(directory, number):
                show(event)
                has_ended = has_ended or isinstance(event, MissionState)
            if not has_ended:
                _tell_no_end(directory)
            return
        system = System(run=directory.path)
    has_ended = system.do(lambda aos: _stream(aos, show, is_following=follow), user=WATCHER)
    if follow and not has_ended and not system.is_at_endpoint:
        # The system stopped meanwhile, and took the end with it.
        for event in _journaled(directory, newest):
            has_ended = has_ended or isinstance(event, MissionState)
            if isinstance(event, MissionState) or (event.mission, event.sequence) not in shown:
                show(event)
        if not has_ended:
            _tell_no_end(directory)


def _tell_no_end(directory: RunDirectory) -> None:
    """Says on standard error that a mission has no end, where nobody is there who could give it one."""
    if not directory.is_running and directory.read_summary() is None:
        what = f"aos: {directory.path.name} was killed before its mission ended"
        typer.echo(f"{what}. `aos-up --resume {from_here(directory.path)}` takes it up", err=True)


def _reason(event: DecisionRecord | MissionState) -> list[str]:
    """Returns the lines below a decision that say why that planner made it."""
    if not isinstance(event, DecisionRecord) or event.outcome is not None or not event.why:
        return []
    if not event.planner:
        return []  # The line of the decision says who has asked for it.
    barred = [why for made in event.searches if not made.is_dropped for why in made.barred.values()]
    others = told_together(barred, after=event.why)
    told = [event.why, f"barred: {others}"] if others else [event.why]
    return [on_one_line(f"         {event.planner}: {'; '.join(told)}")]


def _journaled(directory: RunDirectory, mission: int) -> Iterator[DecisionRecord | MissionState]:
    """The decisions of a mission that is over, and how it ended; by number in a system that stays."""
    from aos_deploy.runs.end import message_of_row
    from aos_runtime.disk.journal import rows_of

    for row in rows_of(mission_folder(directory.path, mission) / JOURNAL):
        event = message_of_row(row)
        if isinstance(event, DecisionRecord) or (event is not None and event.phase == "ended"):
            yield event


async def _stream(aos: AosClient, show: Show, *, is_following: bool) -> bool:
    """Shows decisions as they come; returns whether the mission's end was among them."""
    if not is_following:
        async for record in aos.history():
            show(record)
        return False
    async for event in aos.follow(begins_s=_SOLVER_S):
        if isinstance(event, DecisionRecord):
            show(event)
        elif isinstance(event, MissionState) and event.phase == "ended":
            show(event)
            return True
    return False
