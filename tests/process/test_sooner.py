"""What is worth as much now as later is done now, by every planner that samples."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest
from models import built_text, engine_of

EXIT = {
    "exit.ef": """project: exit
horizon: 30
discount: 0.999999

state_variable: bool has_left

state_variable: double noise

reward_code:
if (state.has_left) __isGoalState = true;
""",
    "leave.sd": """project: exit

dynamic_model:
__reward = 20 + AOS.SampleNormal(0, 5);
state__.has_left = true;
__moduleResponse = done;
""",
    "wait.sd": """project: exit

dynamic_model:
state__.noise = AOS.SampleUniform(0, 1);
__moduleResponse = done;
""",
} | {
    f"{skill}.am": f"""project: exit

response: done
response_rule: True

module_activation: skill
path: /{skill}
"""
    for skill in ("leave", "wait")
}
"""A way out that is paid for, as well now as later, but for luck."""


@pytest.mark.parametrize("planner", ["pomcp", "despot"])
async def test_a_free_exit_is_not_put_off(planner: Literal["pomcp", "despot"], cache_dir: Path) -> None:
    async with engine_of(await built_text(EXIT, cache_dir)) as engine:
        plans = [await engine.plan(simulations=2_000, seed=seed, planner=planner) for seed in range(8)]
    assert [plan.best.action for plan in plans] == ["leave"] * 8
    assert all(plan.best.q == pytest.approx(20, abs=2) for plan in plans)
