"""When a mission is over, and how it ended: the rules that the mission loop and `aos simulate` share."""

from __future__ import annotations

from enum import StrEnum

import msgspec

from aos_protocol.messages import ActionValue, BeliefSummary

__all__ = [
    "Ending",
    "MissionLimits",
    "believed_ending",
    "ending_after_planning",
    "ending_of_belief",
    "remark_of",
]


class Ending(StrEnum):
    """How a mission ends; `SKILLS_FAILED`, `FAULT` and `CANCELLED` come from outside the belief.

    `OVER` is an ending of the documents that is neither a goal nor a failure. `TOO_RISKY` is where every
    action risks more than the mission's constraints allow.
    """

    GOAL = "goal"
    OVER = "over"
    FAILURE = "failure"
    NOTHING_WORTHWHILE = "nothing_worthwhile"
    TOO_RISKY = "too_risky"
    STEP_LIMIT = "step_limit"
    SKILLS_FAILED = "skills_failed"
    CANCELLED = "cancelled"
    FAULT = "fault"


class MissionLimits(msgspec.Struct, frozen=True, kw_only=True):
    """What ends a mission: `goal_probability` holds for the goal and for the other endings alike.

    `stop_below_value` is an expected return: when even the best action promises less, the robot does better
    by doing nothing, which is worth 0. With None no mission stops for that reason.
    """

    goal_probability: float = 0.9
    step_limit: int = 30
    stop_below_value: float | None = None


def believed_ending(belief: BeliefSummary, limits: MissionLimits) -> Ending | None:
    """The ending that a belief holds for sure enough; None where the mission may well go on.

    A mission that is surely over, but not surely in one way, counts as what it is at least: the endings are,
    from the best to the worst, goal, over and failure.
    """
    probability = belief.goal_probability
    if probability >= limits.goal_probability:
        return Ending.GOAL
    probability += belief.over_probability
    if probability >= limits.goal_probability:
        return Ending.OVER
    probability += belief.failure_probability
    return Ending.FAILURE if probability >= limits.goal_probability else None


def ending_of_belief(belief: BeliefSummary, steps_taken: int, limits: MissionLimits) -> Ending | None:
    """The ending that a belief calls for after so many steps; None while there is something left to do."""
    if ending := believed_ending(belief, limits):
        return ending
    if steps_taken >= limits.step_limit:
        return Ending.STEP_LIMIT
    return None


def ending_after_planning(best: ActionValue, limits: MissionLimits) -> Ending | None:
    """The ending that the search's best action calls for.

    The action has the benefit of the doubt: twice its standard error.
    """
    if limits.stop_below_value is None:
        return None
    if best.q + 2 * best.stderr < limits.stop_below_value:
        return Ending.NOTHING_WORTHWHILE
    return None


def remark_of(ending: Ending, belief: BeliefSummary, limits: MissionLimits) -> str:
    """Why a mission ended, in one line for people; where nobody can tell how it ended, it says so."""
    if ending == Ending.GOAL:
        return f"the goal is reached with probability {belief.goal_probability:.3f}"
    if ending == Ending.STEP_LIMIT:
        return f"the step limit of {limits.step_limit} is reached"
    if ending == Ending.NOTHING_WORTHWHILE:
        return f"no action is expected to return more than {limits.stop_below_value}"
    odds = (
        f"goal {belief.goal_probability:.3f}, over {belief.over_probability:.3f}, "
        f"failure {belief.failure_probability:.3f}"
    )
    if ending == Ending.OVER and belief.over_probability >= limits.goal_probability:
        return f"the mission is over without its goal or a failure: {odds}"
    if ending == Ending.FAILURE and belief.failure_probability >= limits.goal_probability:
        return f"the mission is over without its goal: {odds}"
    return f"the mission is over, and nobody can tell how: {odds}"
