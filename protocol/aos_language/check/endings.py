"""Endings that the documents leave to the sign of a reward."""

import re
from collections.abc import Iterable

from aos_language.check.models.blocks import DYNAMIC, SPECIAL, assignment_blocks
from aos_language.findings import Findings
from aos_protocol.documents import Environment, SkillModel, SpecialState

_NEGATIVE = re.compile(r"\b__reward\s*(?:=\s*-|-=)")
_OTHER_REWARD = re.compile(r"\b__reward\s*[+*/]?=(?!=|\s*(?:-|0*\.?0*\s*;))")
_ENDING_WORDS = ("__isGoalState", "__isFailureState")


def check_endings(environment: Environment, findings: Findings) -> None:
    """Terminal states that say nothing of failure, and whose reward is negative or missing."""
    for special in environment.special_states:
        code = _code(special)
        if not (special.is_goal or "__isGoalState" in code):
            continue
        if special.is_failure is not None or "__isFailureState" in code:
            continue
        word = "`__isFailureState = true;`" if code else "`IsFailureState` (SDL: `is_failure_state:`)"
        if _is_negative(special, code):
            message = "an ending that is a failure because its reward is negative"
            if _OTHER_REWARD.search(code):
                message = "an ending that is a failure where its reward is negative"
            findings.remark("AOS137", message, special.span, f"Say so with {word}")
        elif _is_nothing(special, code):
            message = "an ending that is neither goal nor failure because its reward is 0"
            findings.remark("AOS137", message, special.span, f"If it is a failure, say so with {word}")


def check_goals(environment: Environment, models: Iterable[SkillModel], findings: Findings) -> None:
    """Reports AOS139 where no ending can be a goal. It is a remark without endings, as tasks that go on have
    none, and where a skill may pay for an ending whose own reward is 0."""
    endings = [special for special in environment.special_states if _may_end(special)]
    if not endings:
        message = "no special state ends the mission: it runs until its step limit"
        is_json = environment.span.file.endswith(".json")
        words = '`"IsGoalState": true`' if is_json else "`is_goal_state: true`"
        hint = f"If it has a goal, let a special state say {words}, or its code `__isGoalState = true;`"
        findings.remark("AOS139", message, environment.span, hint)
    elif not any(may_be_goal(special) for special in endings):
        unpaid = [special for special in endings if _is_neither(special)]
        if unpaid and any(_pays(model) for model in models):
            message = "no ending is a goal: the reward of this one is 0, whatever a skill pays for it"
            hint = "If it is a goal, say so with `__isFailureState = false;` (SDL: `is_failure_state: false`)"
            findings.remark("AOS139", message, unpaid[0].span, hint)
            return
        message = "no ending is a goal: of each the reward is negative or 0, or it says that it is a failure"
        findings.warning("AOS139", message, endings[0].span, "Give the goal a positive reward")


def _may_end(special: SpecialState) -> bool:
    code = _code(special)
    return special.is_goal or bool(special.is_failure) or any(word in code for word in _ENDING_WORDS)


def may_be_goal(special: SpecialState) -> bool:
    """Returns whether a special state may end the mission as a goal."""
    code = _code(special)
    if not code:
        is_goal = special.is_goal and not special.is_failure
        return is_goal and (special.is_failure is False or special.reward > 0)
    if "__isGoalState" not in code:
        return False
    # One piece of code may tell several endings.
    return "__isFailureState" in code or _OTHER_REWARD.search(code) is not None


def _is_neither(special: SpecialState) -> bool:
    code = _code(special)
    is_told = special.is_failure is not None or "__isFailureState" in code
    return not is_told and not _is_negative(special, code) and _is_nothing(special, code)


def _pays(model: SkillModel) -> bool:
    blocks = assignment_blocks(DYNAMIC, model.dynamic_model)
    return any(_OTHER_REWARD.search(block.snippet.code) for block in blocks)


def _code(special: SpecialState) -> str:
    return " ".join(block.snippet.code for block in assignment_blocks(SPECIAL, special.code))


def _is_negative(special: SpecialState, code: str) -> bool:
    return special.reward < 0 or _NEGATIVE.search(code) is not None


def _is_nothing(special: SpecialState, code: str) -> bool:
    return "__reward" not in code if code else special.reward == 0
