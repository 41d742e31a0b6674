"""A hall where somebody walks, without a mistake, and what the checks say of it with one."""

from texts import encoded

from aos_language.load import load_files
from aos_protocol.diagnostics import Diagnostic

ENVIRONMENT = """project: hall
horizon: 4

define_type: Cell
variable: int x 0

state_variable: Cell first
code:
state.first.x = 1;

state_variable: Cell second
code:
state.second.x = 2;

action_parameter: int near
code:
state.near = 1;

initial_belief:
state.first.x = AOS.Bernoulli(0.5) ? 1 : 2;

reward_code:
if (state.second.x == 3) { __reward = 10; __isGoalState = true; }
"""
SKILL = """project: hall
parameter: int steps

precondition:
__meetPrecondition = state.first.x > 0;
violate_penalty: -1

dynamic_model:
state__.second.x = state.second.x + steps;
__moduleResponse = walked;
"""
SIDES = f"{ENVIRONMENT}\ndefine_type: Side\nenum_members: Left, Right\nstate_variable: Side side\n"
MAPPING = """project: hall
response: walked
response_rule: True

module_activation: skill
path: /walk
parameter: steps
code:
steps

local_variable: steps
action_parameter: steps
"""


def skill_after(code: str) -> str:
    return SKILL.replace("state__.second.x =", f"{code}\nstate__.second.x =")


def found(
    *, environment: str = ENVIRONMENT, skill: str = SKILL, mapping: str = MAPPING
) -> tuple[Diagnostic, ...]:
    files = {"hall.ef": environment, "walk.sd": skill, "walk.am": mapping}
    return load_files(encoded(files)).diagnostics


def finding_texts(**texts: str) -> list[str]:
    return [
        f"{finding.span.line} {finding.code} {finding.message}. {finding.hint}" for finding in found(**texts)
    ]
