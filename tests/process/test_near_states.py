import pytest
from models import built_text, engine_of, engine_of_bundle, engine_of_text
from places import BUNDLES

from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine

COUNT = """
state_variable: int steps

extrinsic_code:
state_.steps = state.steps + 1;

reward_code:
if (state.steps > 1000000) __reward = -1;
"""
"""Nobody plays so long, but a planner cannot know."""


@pytest.fixture
async def counted_tiger() -> BuiltModel:
    files = {file.name: file.read_text() for file in sorted((BUNDLES / "bench" / "tiger").iterdir())}
    return await built_text(files | {"tiger.ef": files["tiger.ef"] + COUNT})


async def decide(engine: Engine, horizon: int) -> Plan:
    plan = await engine.plan(simulations=20_000, seed=1, planner="sarsop", horizon=horizon)
    assert plan.planner == "sarsop"
    return plan


async def test_a_count_that_matters_to_nothing_moves_no_bound(counted_tiger: BuiltModel):
    async with engine_of_bundle(BUNDLES / "bench" / "tiger") as engine, engine_of(counted_tiger) as counted:
        exact = {value.action: value.q for value in (await engine.exact_values(6)).actions}
        plan = await decide(counted, 6)
        assert "that 12 decisions can lead to are listed" in plan.why
        for action in plan.actions:
            assert action.at_least is not None
            assert action.at_most is not None
            assert action.at_least - 1e-6 <= exact[action.action] <= action.at_most + 1e-6
        assert exact[plan.best.action] == pytest.approx(max(exact.values()))


async def test_later_beliefs_are_served_by_lists_of_their_own(counted_tiger: BuiltModel):
    async with engine_of(counted_tiger) as engine:
        first = await decide(engine, 6)
        for sound in ["tiger_left", "tiger_right"] * 15:
            await engine.update("listen", sound)
            plan = await decide(engine, 6)
        assert plan.best.action == first.best.action
        # The tiger is where it was. What is proven of one list is proven of the next one.
        assert plan.best.at_least == pytest.approx(first.best.at_least, abs=0.2)


async def test_a_belief_is_decided_on_that_is_a_hundred_thousand_steps_before_the_only_reward():
    """The states that lead to a reward are found one by one, and not in one pass for each step of the way."""
    files = {
        "count.ef": "project: count\nhorizon: 2\ndiscount: 0.9\nstate_variable: int count\n"
        "initial_belief:\nif (AOS.Bernoulli(0.5)) state.count = 1;\n"
        "reward_code:\nif (state.count >= 99000) { __reward = 10; __isGoalState = true; }\n",
        "step.sd": "project: count\ndynamic_model:\nstate__.count++;\n__moduleResponse = done;\n",
    }
    async with engine_of_text(files) as engine:
        plan = await engine.plan(simulations=20, seed=1, planner="sarsop")
    assert plan.planner == "sarsop"
    assert plan.actions[0].q == pytest.approx(0, abs=1e-6)
