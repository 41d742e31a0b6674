"""The errors of a robot's services and actions, whichever way its nodes are reached."""

from collections.abc import Iterable

from aos_protocol.errors import SkillError

CANCEL_S = 1.8
"""A node may take this long to end a goal after it was asked to: less than an adapter has for it."""


def not_served(message: str, known: Iterable[str]) -> SkillError:
    """The error where no node serves what is called."""
    return SkillError(message, code="AOS505", hint=f"Served are: {', '.join(known) or 'none'}")


def not_answered(service: str, timeout_s: float) -> SkillError:
    """The error where a service took too long."""
    return SkillError(f"{service} did not answer within {timeout_s:g} s", code="AOS503")


def check_type(name: str, found: str, wanted: str) -> None:
    """Raises SkillError AOS509 where what is served is of another type than the wanted one, if any is."""
    if wanted and found != wanted:
        hint = "Correct the type in the deploy file, or leave it out"
        raise SkillError(f"{name} is of type {found}, not {wanted}", code="AOS509", hint=hint)


def not_cancelled(action: str) -> SkillError:
    """The error where a goal does not end although its end was asked for."""
    message = f"{action} was asked to cancel its goal and did not within {CANCEL_S:g} s"
    hint = "The robot may still move: look at it, and at the node's log"
    return SkillError(message, code="AOS504", hint=hint)


def not_ended(action: str, timeout_s: float) -> SkillError:
    """The error where a goal took too long, and was cancelled."""
    return SkillError(f"{action} did not end within {timeout_s:g} s and was cancelled", code="AOS503")


def node_lost(action: str) -> SkillError:
    """The error where the node of an action leaves while a goal runs."""
    hint = "Whether the skill did its work is not known"
    return SkillError(f"the node that serves {action} has left while it ran", code="AOS504", hint=hint)


def goal_forgotten(action: str) -> SkillError:
    """The error where the node that is asked for a result does not know the goal."""
    message = f"the node of {action} does not know the goal that was accepted"
    hint = "Was the node started anew meanwhile, or do two nodes serve it? What the skill did is not known"
    return SkillError(message, code="AOS504", hint=hint)
