from statistics import fmean

from models import engine_of_text, simulated
from wide.photo import photo


async def test_a_drone_looks_for_a_cell_and_comes_home_with_a_photo():
    """A drone without a price of information flies to and fro: -0.6 in these worlds, and 25 with it."""
    async with engine_of_text(photo(8)) as engine:
        plan = await engine.plan(simulations=500, seed=1, planner="auto")
        assert plan.planner == "pomcp"
        assert "information has a price" in plan.why
        limits = {"goal_probability": 1, "step_limit": 80}
        runs = [await simulated(engine, 500, seed=seed, **limits) for seed in (101, 102)]
    assert plan.best.q < 30, "the tree alone promises 40"
    assert fmean(run.discounted_return for run in runs) > 15
    assert all("take" in run.actions for run in runs)
