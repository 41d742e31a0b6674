"""The documents of a robot whose one skill counts: its mission is over after `STEPS` steps."""

from __future__ import annotations

__all__ = ["counting"]

_ENVIRONMENT = """project: PROJECT
horizon: 2
discount: 0.9

state_variable: int count

initial_belief:
state.count = 0;

reward_code:
if (state.count >= STEPS) { __reward = 10; __isGoalState = true; }
"""
_SKILL = """project: PROJECT

dynamic_model:
state__.count = state.count + 1;
__moduleResponse = done;
"""
_MAPPING = """project: PROJECT

module_activation: skill
path: /step
response: done
response_rule: True
"""


def counting(project: str) -> dict[str, str]:
    """The files below `documents`; whoever writes them puts a number in place of `STEPS`."""
    files = {
        f"documents/{project}.ef": _ENVIRONMENT,
        "documents/step.sd": _SKILL,
        "documents/step.am": _MAPPING,
    }
    return {name: text.replace("PROJECT", project) for name, text in files.items()}
