"""Models whose states can be listed although there are too many observations to list."""

from __future__ import annotations

from pathlib import Path

import pytest
from models import built_text, engine_of

CORRIDOR = {
    "corridor.ef": """project: corridor
horizon: 40
discount: 0.95

state_variable: int cell

initial_belief:
state.cell = AOS.Bernoulli(0.5) ? 1 : 2;

reward_code:
if (state.cell == 8) {
    __reward = 50;
    __isGoalState = true;
}
""",
    "walk.sd": """project: corridor
dynamic_model:
if (state.cell < 8 && AOS.Bernoulli(0.9)) state__.cell++;
__reward = -1;
__moduleResponseStr = "";
for (int i = 0; i < 12; i++) __moduleResponseStr += char('a' + int(AOS.SampleUniform(0, 20)));
""",
    "walk.am": """project: corridor
module_activation: skill
path: /walk

local_variable: code
type: string
from_ros_service_response: true
code:
code = __input.code

response_local_variable: code
""",
}


def fully_observable_value(cell: int) -> float:
    """Of walking on: V(c) = -1 + 0.95 (0.9 V(c + 1) + 0.1 V(c)); the step into the goal earns 50 at once."""
    value = (-1 + 0.9 * 50) / (1 - 0.95 * 0.1)
    for _ in range(8 - cell - 1):
        value = (-1 + 0.95 * 0.9 * value) / (1 - 0.95 * 0.1)
    return value


async def test_states_are_listed_without_what_is_observed_and_values_follow_from_them(
    cache_dir: Path,
) -> None:
    built = await built_text(CORRIDOR, cache_dir)
    async with engine_of(built) as engine:
        plan = await engine.plan(simulations=300, seed=1, planner="auto")
    assert plan.planner == "pomcp"
    assert "all 7 states can be listed, but not what is observed: a draw is continuous" in plan.why
    expected = (fully_observable_value(1) + fully_observable_value(2)) / 2
    (walk,) = plan.actions
    assert walk.q == pytest.approx(expected, rel=0.02)
    # Without values of states, 300 play-outs would differ by more.
    assert walk.stderr < 1


async def test_sarsop_is_told_why_it_cannot_be_used(cache_dir: Path) -> None:
    built = await built_text(CORRIDOR, cache_dir)
    async with engine_of(built) as engine:
        plan = await engine.plan(simulations=50, seed=1, planner="sarsop")
    assert plan.planner == "pomcp"
    assert plan.why == "SARSOP cannot be used: a draw is continuous"
