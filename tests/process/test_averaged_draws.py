import pytest
from models import engine_of_text

EXIT = {
    "ward.ef": """project: ward
horizon: 30
discount: 0.999999

state_variable: bool has_left

reward_code:
if (state.has_left) __isGoalState = true;
""",
    "leave.sd": """project: ward
dynamic_model:
state__.has_left = true;
double pay = AOS.SampleNormal(20, 5);
__reward = pay - 1;
__moduleResponse = done;
""",
    "wait.sd": """project: ward
dynamic_model:
__reward = -AOS.SampleUniform(-1, 1);
__moduleResponse = done;
""",
}


LEAVE = 0


async def test_an_exit_of_noisy_worth_is_worth_its_mean_and_is_not_put_off():
    async with engine_of_text(EXIT) as engine:
        plan = await engine.plan(simulations=2000, seed=1, planner="auto")
        assert plan.planner == "exact"
        leave, wait = plan.actions
        assert leave.q == pytest.approx(19, abs=1e-9)
        assert wait.q == pytest.approx(19 * 0.999999, abs=1e-6)
        assert plan.best is leave
        await engine.update("wait", "done")
        assert (await engine.summary()).is_exact


async def test_the_world_still_draws_the_reward():
    async with engine_of_text(EXIT) as engine:
        rewards = []
        for seed in range(200):
            await engine.reset_world(seed)
            rewards.append((await engine.step_world(LEAVE)).reward)
    mean = sum(rewards) / len(rewards)
    deviation = (sum((reward - mean) ** 2 for reward in rewards) / len(rewards)) ** 0.5
    assert mean == pytest.approx(19, abs=4 * 5 / 200**0.5)
    assert deviation == pytest.approx(5, rel=0.2)
