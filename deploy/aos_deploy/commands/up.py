"""`aos-up`, also `aos up`: brings a whole system up and runs its mission."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple, NoReturn

import typer
from msgspec.structs import replace

from aos_deploy.deployment.mission_values import SetValues
from aos_deploy.deployment.parts import MAX_SEED
from aos_deploy.exit_codes import EXIT_CODES_TEXT
from aos_deploy.options import HELP_NAMES, TrustDocuments, Version, command
from aos_deploy.printing import print_fault
from aos_deploy.told_numbers import NumbersToldCommand

if TYPE_CHECKING:
    from aos_deploy.deployment.reading import Deployment
    from aos_protocol.errors import AosError

_EPILOG = (
    "Example: aos-up deploy/armadillo.yaml --seed 7. Another terminal can follow with `aos decisions`. "
    + EXIT_CODES_TEXT
)


class UpOptions(NamedTuple):
    """The deploy file, or the run that goes on, and what is said otherwise than there."""

    deploy: Annotated[
        Path | None, typer.Argument(metavar="DEPLOY", help="The deploy file; with --resume a run directory")
    ] = None
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", help="Go on with a run whose aos-up has died, by default with the last one in ./runs"
        ),
    ] = False
    seed: Annotated[
        int | None,
        typer.Option(
            min=0, max=MAX_SEED, help="Seed of the planner and of the world, in place of the file's"
        ),
    ] = None
    listen: Annotated[
        str | None, typer.Option(metavar="ENDPOINT", help="Where the bus listens; port 0 takes any free one")
    ] = None
    runs: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Where the run directory goes", file_okay=False)
    ] = None
    set_values: SetValues = None
    model: Annotated[
        bool, typer.Option("--model", help="Every skill is played by its own document; no robot is needed")
    ] = False
    serve: Annotated[
        str | None,
        typer.Option(
            metavar="KIND",
            help="Run no mission: serve the skills and topics to others, as ros2, dds or ros1, until Ctrl-C",
        ),
    ] = None
    stay: Annotated[
        bool,
        typer.Option(
            "--stay",
            help="Go on after the mission, and wait for `aos mission start`, until Ctrl-C: its exit code is "
            "130 while a mission runs, else 0",
        ),
    ] = False
    page: Annotated[
        bool, typer.Option("--page", help="Print the address of the mission's page; see aos serve")
    ] = False


@command(_EPILOG, cls=NumbersToldCommand, context_settings=HELP_NAMES)
def up(
    options: UpOptions,
    plain: Annotated[bool, typer.Option("--plain", help="Plain lines, on a terminal too")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line for each event")] = False,
    version: Version = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Bring a robot's system up and run its mission.

    Starts the bus router, registry, middleware, skills and solver as processes of their own, gives the
    registry the documents, and shows what the robot decides until the mission ends. Ctrl-C stops all of it in
    order, a second Ctrl-C at once. The run directory keeps the journal, the logs and the pictures.
    """
    import asyncio  # For --help none of this is needed.

    from aos_deploy.deployment.reading import read_deploy_file
    from aos_deploy.interruption import run_until_interrupted, told_while_read
    from aos_deploy.missions.mission_run import MissionRun
    from aos_deploy.missions.serve_run import ServeRun
    from aos_deploy.missions.system_run import SystemRun
    from aos_deploy.missions.taking_up import take_up
    from aos_deploy.processes.needed_here import check_needed_here, check_sandbox
    from aos_deploy.runs.directory import RunDirectory
    from aos_deploy.runs.living import runs_here
    from aos_deploy.views import make_view
    from aos_runtime.clock import SystemClock

    serve = options.serve
    if serve is not None:
        _refuse(options, ("stay", "page"), "no mission runs that others could follow")
    if options.resume:
        fixed = ("seed", "listen", "runs", "serve", "set", "model", "stay")
        _refuse(options, fixed, "a run that goes on has what it was started with")
        deployment, taken_up = take_up(options.deploy or RunDirectory.latest(runs_here()).path)
    elif options.deploy is None:
        raise typer.BadParameter("name the deploy file, or use --resume", param_hint="DEPLOY")
    else:
        deployment, taken_up = read_deploy_file(options.deploy), None
    deployment = _with_options(deployment, options)
    check_sandbox(deployment)
    check_needed_here(deployment)
    is_terminal = sys.stdout is not None and sys.stdout.isatty()  # None where it was closed before.
    view = make_view(_title(deployment), is_plain=plain, is_json=as_json, is_terminal=is_terminal)
    is_unread = asyncio.Event()
    report, clock = told_while_read(view, is_unread), SystemClock()
    if serve is not None:
        mission: MissionRun | ServeRun = ServeRun(deployment, serve, report, clock)
    else:
        kind = SystemRun if deployment.file.stay else MissionRun
        mission = kind(
            deployment, report, clock, taken_up=taken_up, is_played=options.model, shows_page=options.page
        )
    with view:
        code = asyncio.run(run_until_interrupted(mission, is_unread))
    _end(mission.error, code)


def _end(error: AosError | None, code: int) -> NoReturn:
    """Prints the fault that a run has ended by, if any, and ends the command."""
    if error is not None:
        print_fault("aos-up", error)
    raise typer.Exit(code)


def _refuse(options: UpOptions, names: Iterable[str], why: str) -> None:
    """BadParameter where one of these options is given."""
    values = options._asdict() | {"set": options.set_values or None}
    given = [f"--{name}" for name in names if values[name] is not None and values[name] is not False]
    if given:
        raise typer.BadParameter(why, param_hint=", ".join(given))


def _title(deployment: Deployment) -> str:
    return f"{deployment.file.robot} · {deployment.path.name}"


def _with_options(deployment: Deployment, options: UpOptions) -> Deployment:
    """The deployment with what the command says otherwise; of two values for a parameter the last counts."""
    from aos_deploy.deployment.mission_values import values_of_options
    from aos_deploy.deployment.reading import check_endpoint, without_a_robot

    file, solver = deployment.file, deployment.file.solver
    if options.stay:
        file = replace(file, stay=True)
    if options.seed is not None:
        file = replace(file, solver=replace(solver, seed=options.seed))
    if options.listen is not None:
        check_endpoint(options.listen)
        file = replace(file, bus=replace(file.bus, listen=options.listen))
    deployment = replace(
        deployment,
        file=file,
        mission_values=(*deployment.mission_values, *values_of_options(options.set_values)),
        runs=options.runs.resolve() if options.runs is not None else deployment.runs,
    )
    return without_a_robot(deployment) if options.model else deployment
