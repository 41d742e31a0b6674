"""Endings that the documents leave to the sign of a reward."""

from __future__ import annotations

import re

from aos_protocol.documents import Environment, SpecialState
from aos_protocol.findings import Findings
from aos_registry.check.blocks import SPECIAL, assignment_blocks

__all__ = ["check_endings"]

_NEGATIVE = re.compile(r"\b__reward\s*(?:=\s*-|-=)")


def check_endings(environment: Environment, findings: Findings) -> None:
    """Terminal states that say nothing of failure, and whose reward is negative or missing."""
    for special in environment.special_states:
        code = " ".join(block.snippet.code for block in assignment_blocks(SPECIAL, special.code))
        if not (special.is_goal or "__isGoalState" in code):
            continue
        if special.is_failure is not None or "__isFailureState" in code:
            continue
        word = "`__isFailureState = true;`" if code else "`IsFailureState` (SDL: `is_failure_state:`)"
        if _is_negative(special, code):
            message = "an ending that is a failure because its reward is negative"
            findings.remark("AOS137", message, special.span, f"Say so with {word}")
        elif _is_nothing(special, code):
            message = "an ending that is neither goal nor failure because its reward is 0"
            findings.remark("AOS137", message, special.span, f"If it is a failure, say so with {word}")


def _is_negative(special: SpecialState, code: str) -> bool:
    return special.reward < 0 or _NEGATIVE.search(code) is not None


def _is_nothing(special: SpecialState, code: str) -> bool:
    return "__reward" not in code if code else special.reward == 0
