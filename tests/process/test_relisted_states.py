import pytest
from models import engine_of_text

from aos_solver.child.engine import Planner

CELLS = 60

VAULT = {
    "vault.ef": f"""project: vault
horizon: {CELLS + 20}
discount: 0.99

state_variable: int code

state_variable: bool is_full

state_variable: int cell

state_variable: bool is_open

initial_belief:
state.code = AOS.SampleDiscrete(vector<double>(9000, 1.0 / 9000));
state.is_full = AOS.Bernoulli(0.5);

reward_code:
if (state.is_open) __isGoalState = true;
""",
    "look.sd": """project: vault
dynamic_model:
__moduleResponseStr = to_string(state.code) + (state.is_full ? " full" : " empty");
""",
    "walk.sd": f"""project: vault
dynamic_model:
if (state.cell < {CELLS}) state__.cell++;
__moduleResponseStr = "done";
""",
    "open.sd": f"""project: vault
dynamic_model:
if (state.cell == {CELLS}) {{
    state__.is_open = true;
    __reward = state.is_full ? 100 : -100;
}}
__moduleResponseStr = "done";
""",
}

WORTH = {"7 full": 100 * 0.99**CELLS, "8 empty": 0.0, "9 full": 100 * 0.99**CELLS}
"""The values after the look, with the way to go."""


@pytest.mark.parametrize("planner", ["sarsop", "pomcp"])
async def test_a_listing_of_as_many_other_states_is_not_taken_for_the_last_one(planner: Planner):
    async with engine_of_text(VAULT) as engine:
        for response, worth in WORTH.items():
            # A million states are too many to list. After a look they are 61, every time others.
            await engine.reset_belief()
            await engine.plan(simulations=20, seed=1, planner="auto")
            await engine.update("look", response)
            plan = await engine.plan(simulations=2000, seed=1, planner=planner)
            assert plan.best.q == pytest.approx(worth, abs=0.01), response
