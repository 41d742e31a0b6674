"""`aos mission`: the missions of a system, one after the other, and steering the one that runs."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from msgspec.structs import replace

from aos_deploy.commands import steering
from aos_deploy.deployment.mission_values import SetValues, values_of_options
from aos_deploy.exit_codes import EXIT_CODES_TEXT, exit_code_of_ending
from aos_deploy.options import AsJson, add_commands, grouped
from aos_deploy.printing import count, print_json
from aos_deploy.running_system import System
from aos_deploy.runs.living import chosen_run
from aos_protocol.messages import MissionEntry, MissionState

if TYPE_CHECKING:
    from aos_runtime.client import AosClient

mission_app = typer.Typer(
    name="mission",
    no_args_is_help=True,
    help="Start, stop, list and steer missions. Further missions need `aos-up --stay`.",
    epilog="Example: aos mission start --set target=bob --belief keep --given 'state.robot == kitchen'",
)

Belief = Annotated[
    Literal["initial", "keep"], typer.Option(help="The documents' initial belief, or what was believed last")
]
Given = Annotated[
    list[str] | None,
    typer.Option(
        "--given", metavar="EXPRESSION", help="What is known: over `state`, in the documents' language"
    ),
]
Idle = Annotated[
    int, typer.Option("--idle", min=0, max=10_000, metavar="N", help="Steps of extrinsic changes before it")
]


@mission_app.command(
    epilog="Example: aos mission start --belief keep --wait. With --wait it exits as aos-up does. "
    + EXIT_CODES_TEXT
)
@grouped
def start(
    system: System,
    belief: Belief = "initial",
    given: Given = None,
    idle: Idle = 0,
    set_values: SetValues = None,
    wait: Annotated[
        bool, typer.Option("--wait", help="Return when it has ended, with its exit code")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Start the next mission.

    First the steps of `--idle` pass, then the belief is conditioned on what is `--given`. Flags of special
    states that count once, constraints, steps and the seed begin anew, whatever the belief.
    """

    import asyncio

    values = {value.name: value.text for value in values_of_options(set_values)}

    async def work(aos: AosClient) -> MissionState | MissionEntry:
        state = await aos.start_mission(belief=belief, given=given or (), idle=idle, values=values)
        if not wait:
            return state
        if not as_json:
            typer.echo(f"{state.mission} has begun")
        try:
            return await aos.until_ended(state.mission)
        except asyncio.CancelledError:
            typer.echo(f"aos: {state.mission} goes on; `aos mission stop` ends it", err=True)
            raise

    outcome = system.do(work)
    if as_json:
        print_json(outcome)
    elif isinstance(outcome, MissionEntry):
        typer.echo(
            f"{outcome.mission}: {outcome.ending} after {count(outcome.steps, 'step')}, {outcome.remark}"
        )
    else:
        typer.echo(f"{outcome.mission} has begun")
    if isinstance(outcome, MissionEntry):
        raise typer.Exit(exit_code_of_ending(outcome.ending))


@mission_app.command(epilog="Example: aos mission stop")
@grouped
def stop(system: System, as_json: AsJson = False) -> None:
    """Cancel what moves, and end the mission.

    Its ending is `cancelled`. It returns when the mission has ended. Where none runs, nothing changes.
    """

    async def work(aos: AosClient) -> tuple[MissionState, MissionState]:
        return await aos.mission_state(), await aos.stop_mission()

    before, after = system.do(work)
    if as_json:
        print_json(after)
    elif after.phase != "ended":
        typer.echo(
            f"{after.mission} does not begin: {after.remark}" if after.remark else "no mission has begun"
        )
    elif before.phase == "ended":
        typer.echo(f"no mission runs: {after.mission} has ended, {after.ending}")
    else:
        typer.echo(f"{after.mission}: {after.ending} after {count(after.step, 'step')}")


@mission_app.command("list", epilog="Example: aos mission list --json")
@grouped
def list_missions(system: System, as_json: AsJson = False) -> None:
    """List the missions of a system, also of one that is over."""
    entries = _entries(system)
    if as_json:
        print_json(entries)
        return
    for entry in entries:
        typer.echo(_line(entry))
    if not entries:
        typer.echo("no mission has begun")


def _entries(system: System) -> tuple[MissionEntry, ...]:
    if not system.is_at_endpoint:
        run = chosen_run(system.run, system.runs)
        if not run.is_running:
            return _kept_entries(run.path)

    async def work(aos: AosClient) -> tuple[MissionEntry, ...]:
        return (await aos.missions()).entries

    return system.do(work)


def _kept_entries(run: Path) -> tuple[MissionEntry, ...]:
    from aos_solver.mission.records.logbook import entries_of

    entries = entries_of(run)
    return tuple(replace(entry, ending=entry.ending or "killed") for entry in entries)


def _line(entry: MissionEntry) -> str:
    begun = datetime.fromtimestamp(entry.begun_ns / 1e9).astimezone().isoformat(" ", "seconds")
    began = [entry.belief, *(f"given {text}" for text in entry.given)]
    began += [f"{name} = {text}" for name, text in entry.values.items()]
    if entry.idle:
        began.append(f"after {count(entry.idle, 'idle step')}")
    ending = entry.ending or "running"
    steps = count(entry.steps, "step")
    now = "" if entry.ending or not entry.remark else f"; {entry.remark}"
    return f"{ending:18} {steps:>9}  {begun}  {entry.mission}  seed {entry.seed}, {', '.join(began)}{now}"


add_commands(mission_app, steering)
