"""`aos down`: ends a system that runs."""

import time
from typing import Annotated

import typer

from aos_deploy.commands.runs import entry_of, print_entries
from aos_deploy.options import AsJson, Run, Runs, command
from aos_deploy.printing import print_json
from aos_deploy.runs.living import living_run, living_system
from aos_protocol.errors import BusError

_END_S = 60.0
"""An ordered end takes less."""
_LOOK_S = 0.1


@command("Example: aos down deploy/armadillo.yaml")
def down(
    system: Annotated[
        str | None, typer.Argument(help="The robot's name or the deploy file; else the system that runs")
    ] = None,
    run: Run = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """End a running system in order.

    It is ended as by Ctrl-C in its terminal: what moves is cancelled, and the mission ends. The command
    returns when all has ended, and tells how, as `aos runs` does. `aos mission stop` ends the mission alone.
    """
    directory = living_run(run, runs) if system is None else living_system(system, runs)
    pid = directory.read_record().pid
    if not directory.interrupt(pid):
        raise BusError(f"the aos-up of {directory.path}, process {pid}, cannot be reached", code="AOS605")
    last_s = time.monotonic() + _END_S
    while directory.is_held:
        if time.monotonic() > last_s:
            hint = f"Once more ends it at once, as `kill {pid}` does"
            raise BusError(f"{directory.path} was asked to end, and has not yet", code="AOS601", hint=hint)
        time.sleep(_LOOK_S)
    entry = entry_of(directory)
    if as_json:
        print_json(entry)
    else:
        print_entries([entry])
