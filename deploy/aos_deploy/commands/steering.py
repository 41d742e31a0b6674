"""`aos mission hold`, `step`, `resume`, `do`, `script`, `leave-out`, `take-back`: steering what runs."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from aos_deploy.options import AsJson, command
from aos_deploy.printing import count, show
from aos_deploy.running_system import System
from aos_protocol.errors import DeployError
from aos_protocol.messages import MissionState

if TYPE_CHECKING:
    from aos_runtime.client import AosClient

Name = Annotated[str, typer.Argument(metavar="NAME", help="A skill, or a grounded action such as 'go(to=a)'")]


@command("Example: aos mission hold")
def hold(system: System, as_json: AsJson = False) -> None:
    """Decide nothing more, until `step`, `resume` or `do`.

    The step that runs is brought to its end. Actions that were asked for and have not begun are dropped.
    """
    _steer(system, lambda aos: aos.hold(), as_json, _held)


@command("Example: aos mission step")
def step(system: System, as_json: AsJson = False) -> None:
    """Make one more decision, carry it out, and hold then."""
    _steer(system, lambda aos: aos.step(), as_json, lambda state: "one more decision, then it holds")


@command("Example: aos mission resume")
def resume(system: System, as_json: AsJson = False) -> None:
    """Go on with a mission, whoever or whatever holds it."""
    _steer(system, lambda aos: aos.resume(), as_json, lambda state: "the mission goes on")


@command("Example: aos mission do 'navigate(destination=corridor)'", "do")
def act(
    system: System,
    action: Annotated[
        str, typer.Argument(help="A grounded action, as `aos plan` and `aos decisions` show it")
    ],
    as_json: AsJson = False,
) -> None:
    """Carry out an action of your own.

    It is the next decision, also while the mission holds. The belief is updated by it as by any other. It
    returns once the action has begun. A constraint that it exceeds, and a skill that cannot be run, refuse
    it.
    """
    _steer(system, lambda aos: aos.act(action), as_json, lambda state: f"step {state.step}: {action}")


@command("Example: aos mission script docs/examples/actions.txt")
def script(
    system: System,
    file: Annotated[Path, typer.Argument(metavar="FILE", help="One action a line; # begins a comment")],
    as_json: AsJson = False,
) -> None:
    """Carry out the actions of a file in their order.

    They are the next decisions, also while the mission holds. It returns at once. Where an action is refused,
    fails or ends otherwise than observed, the rest is dropped, and the mission holds.
    """
    actions = actions_of_script(file)
    said = f"{count(len(actions), 'action')} asked for"
    _steer(system, lambda aos: aos.run_script(actions), as_json, lambda state: said)


@command("Example: aos mission leave-out pick", "leave-out")
def leave_out(system: System, name: Name, as_json: AsJson = False) -> None:
    """Decide without a skill or a grounded action.

    It is left out of what is looked ahead, too, until `aos mission take-back`.
    """
    _steer(system, lambda aos: aos.leave_out(name), as_json, _without)


@command("Example: aos mission take-back pick", "take-back")
def take_back(system: System, name: Name, as_json: AsJson = False) -> None:
    """Decide with what was left out again."""
    _steer(system, lambda aos: aos.take_back(name), as_json, _without)


def actions_of_script(file: Path) -> tuple[str, ...]:
    """The actions in a file, one a line; DeployError if it cannot be read or has none."""
    try:
        lines = file.read_text().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", "it is no text")
        raise DeployError(f"{file} cannot be read: {why}", code="AOS101") from error
    actions = tuple(line for line in (text.partition("#")[0].strip() for text in lines) if line)
    if not actions:
        raise DeployError(f"{file} has no action", code="AOS901", hint="Write one grounded action a line")
    return actions


def _steer(
    system: System,
    work: Callable[[AosClient], Awaitable[MissionState]],
    as_json: bool,
    said: Callable[[MissionState], str],
) -> None:
    state = system.do(work)
    show(state, as_json, lambda state: typer.echo(f"{state.mission}: {said(state)}"))


def _held(state: MissionState) -> str:
    if state.phase == "acting":
        return f"{state.held_by} holds it after step {state.step}, which is under way: {state.remark}"
    if state.phase == "planning":
        return f"after {count(state.step, 'step')}: {state.remark}"
    return f"{state.held_by} holds it after {count(state.step, 'step')}"


def _without(state: MissionState) -> str:
    left_out = [f"{name} (by {by})" for name, by in state.left_out.items()]
    return f"decisions do without {', '.join(left_out)}" if left_out else "nothing is left out"
