"""Problems with too many states to list: what POMCP learns of their states before the first decision."""

from __future__ import annotations

from pathlib import Path

from models import built_text, engine_of

BOXES = {
    "boxes.ef": """project: boxes
horizon: 20
discount: 0.9

state_variable: bool full []
code:
state.full.assign(24, false);

initial_belief:
for (int i = 0; i < 24; i++) state.full[i] = AOS.Bernoulli(i == 17 ? 0.9 : 0.3);
""",
    "open.sd": """project: boxes
parameter: int box

available_parameters_code:
for (int i = 0; i < 24; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
__reward = state.full[box] ? 1 : 0;
__moduleResponse = state.full[box] ? found : nothing;
state__.full[box] = false;
""",
    "open.am": """project: boxes

response: found
response_rule: code == 'found'
response: nothing
response_rule: True

module_activation: skill
path: /open
parameter: box
code:
box

local_variable: box
action_parameter: box

local_variable: code
type: string
from_ros_service_response: true
code:
code = __input.code
""",
}
"""Each of 24 boxes may hold one coin: sixteen million states."""


async def test_the_same_seed_learns_the_same(cache_dir: Path) -> None:
    built = await built_text(BOXES, cache_dir)
    plans = []
    for _ in range(2):
        async with engine_of(built) as engine:
            plans.append(await engine.plan(simulations=500, seed=3, planner="pomcp"))
    assert plans[0].actions == plans[1].actions
