"""The end of a mission, and how it ended: the rules that the mission loop and `aos simulate` share."""

from collections.abc import Sequence
from enum import StrEnum

import msgspec

from aos_protocol.chances import chance_text
from aos_protocol.messages import ActionValue, BeliefSummary, EndingOdds


class Ending(StrEnum):
    """The ways in which a mission ends; `SKILLS_FAILED`, `FAULT` and `CANCELLED` come from outside the
    belief.

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
    """The limits that end a mission: `goal_probability` holds for the goal and for the other endings alike.

    `stop_below_value` is an expected return: when no action promises so much, the robot does better by doing
    nothing, which is worth 0. With None no mission stops for that reason.
    """

    goal_probability: float = 0.9
    step_limit: int = 30
    stop_below_value: float | None = None

    @property
    def worth_of_stopping(self) -> float:
        """The return of doing nothing."""
        return self.stop_below_value if self.stop_below_value is not None else 0.0

    @property
    def stops_for_nothing(self) -> bool:
        """True if the mission ends where it could as well do nothing for ever."""
        return self.stop_below_value is not None and self.stop_below_value >= 0

    @property
    def refuted_below(self) -> float:
        """The cautious belief is refuted once observations are less probable in it by this factor.

        Where it is true, that happens with this probability at most, a tenth of what `goal_probability`
        leaves for errors.
        """
        return (1 - self.goal_probability) / 10


_WORST = (Ending.GOAL, Ending.OVER, Ending.FAILURE)
_ROUNDING = 1e-9


def believed_ending(belief: BeliefSummary, limits: MissionLimits) -> Ending | None:
    """The ending that a belief holds for sure enough; None where the mission may well go on.

    A mission that is surely over, but not surely in one way, counts as what it is at least: the endings are,
    from the best to the worst, goal, over and failure. It goes on where what is not over could yet make it a
    better one. It is no better than where nothing ran that was not observed, and not over where it goes on
    there.
    """
    held = _held_ending(belief, limits)
    if held is None or belief.cautious is None:
        return held
    held_cautiously = _held_ending(belief.cautious, limits)
    return None if held_cautiously is None else max(held, held_cautiously, key=_WORST.index)


def is_held_back(belief: BeliefSummary, limits: MissionLimits) -> bool:
    """Returns whether the mission would be over, but for what nobody has observed."""
    return _held_ending(belief, limits) is not None and believed_ending(belief, limits) is None


def _held_ending(belief: BeliefSummary | EndingOdds, limits: MissionLimits) -> Ending | None:
    wanted, goal = limits.goal_probability, belief.goal_probability
    no_failure = goal + belief.over_probability
    is_over = no_failure + belief.failure_probability
    goes_on = 1 - is_over if is_over < 1 - _ROUNDING else 0.0
    if goal >= wanted:
        return Ending.GOAL
    if no_failure >= wanted and goal + goes_on < wanted:
        return Ending.OVER
    return Ending.FAILURE if is_over >= wanted and no_failure + goes_on < wanted else None


def ending_of_belief(belief: BeliefSummary, steps_taken: int, limits: MissionLimits) -> Ending | None:
    """The ending that a belief calls for after so many steps; None while there is something left to do."""
    if ending := believed_ending(belief, limits):
        return ending
    if steps_taken >= limits.step_limit:
        return Ending.STEP_LIMIT
    return None


def ending_after_planning(
    best: ActionValue, actions: Sequence[ActionValue], limits: MissionLimits
) -> Ending | None:
    """The ending that a decision for the `best` of the `actions` calls for.

    To give up wrongly loses the whole mission, and to go on wrongly a step. So where it is proven what
    actions return at most, the mission goes on while one of them may return enough. Where nothing is proven,
    the estimate has twice its standard error as the benefit of the doubt.
    """
    if limits.stop_below_value is None:
        return None
    proven = [action.at_most for action in actions if action.at_most is not None]
    most = max(proven) if proven else best.q + 2 * best.stderr
    return Ending.NOTHING_WORTHWHILE if most < limits.stop_below_value else None


def is_worth_nothing(best: ActionValue, limits: MissionLimits) -> bool:
    """Returns whether nothing is known that returns more than to do nothing.

    Where nothing is proven, the estimate has twice its standard error as the benefit of the doubt.
    """
    known = best.q + 2 * best.stderr if best.at_least is None else best.at_least
    return known <= limits.worth_of_stopping


def remark_of(ending: Ending, belief: BeliefSummary, limits: MissionLimits) -> str:
    """Says why a mission ended, in one line for people; where nobody can tell how it ended, it says so."""
    if ending == Ending.GOAL:
        reached = f"the goal is reached with probability {chance_text(belief.goal_probability)}"
        unless = ""
        if belief.cautious:
            cautious = chance_text(belief.cautious.goal_probability)
            unless = f", and {cautious} if nothing ran that was not observed"
        return f"{reached}, as the belief has it{unless}"
    if ending == Ending.STEP_LIMIT:
        return f"the step limit of {limits.step_limit} is reached"
    if ending == Ending.NOTHING_WORTHWHILE:
        return f"no action is expected to return more than {limits.stop_below_value}"
    odds = (
        f"goal {chance_text(belief.goal_probability)}, over {chance_text(belief.over_probability)}, "
        f"failure {chance_text(belief.failure_probability)}"
    )
    if ending == Ending.OVER and belief.over_probability >= limits.goal_probability:
        return f"the mission is over without its goal or a failure: {odds}"
    if ending == Ending.FAILURE and belief.failure_probability >= limits.goal_probability:
        return f"the mission is over without its goal: {odds}"
    return f"the mission is over, nobody can tell how, and it counts as {ending}: {odds}"
