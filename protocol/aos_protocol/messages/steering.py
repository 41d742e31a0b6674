"""Steering: what an operator wants of a mission that runs, and what became of it."""

from typing import Literal

from aos_protocol.messages.base import Message

SteeringVerb = Literal["hold", "step", "resume", "stop", "act", "script", "leave_out", "take_back"]
"""The things that somebody can want of a mission that runs; Steer says what each does."""


class Steer(Message, frozen=True):
    """Steers the mission that runs. It acts at the next decision, and is the journal's row for itself.

    `hold` decides nothing more, and drops the actions that were asked for. `step` makes one more decision and
    holds then. `resume` goes on with a mission that holds, whatever it holds for. `stop` cancels what moves
    and ends the mission as `cancelled`. `act` carries out the one action in `actions`, `script` all of them
    in their order, also while the mission holds; the planner decides nothing before they are over.
    `leave_out` decides without the skill or the grounded action `name`, now and in what is looked ahead,
    until `take_back`.

    `by` is who asks, as they say; where it is empty the solver writes that it was not told. An empty
    `mission` is the one that runs. One `request` acts once, however often it is asked for. The answer is the
    MissionState, for `act` once the action was decided for, for `stop` once the mission has ended. AOS517
    says why something cannot be done, and AOS518 why an action was refused; nothing has changed then.
    """

    verb: SteeringVerb
    actions: tuple[str, ...] = ()
    name: str = ""
    by: str = ""
    mission: str = ""
    request: str = ""
    reason: str = ""


class ActionRefused(Message, frozen=True):
    """The journal's row for an action that somebody asked for and that is not carried out, with the reason.

    Where it is of a script, the rest of the script is dropped and the mission holds.
    """

    action: str
    request: str
    why: str
    hint: str = ""
