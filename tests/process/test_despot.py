from models import engine_of_bundle, engine_of_text
from places import BUNDLES

from aos_solver.child.engine import Restriction

COUNTER = {
    "counter.ef": """project: counter
horizon: 10
discount: 0.95

state_variable: double level

initial_belief:
state.level = AOS.SampleUniform(0, 1);
""",
    "bet.sd": """project: counter

dynamic_model:
__reward = state.level > 0.8 ? 10 : -10;
__moduleResponse = done;
""",
    "wait.sd": """project: counter

dynamic_model:
__reward = -1;
state__.level = AOS.SampleUniform(0, 1);
__moduleResponse = done;
""",
    "stop.sd": """project: counter

dynamic_model:
__moduleResponse = done;
""",
}
"""A level that is drawn anew by waiting: to bet loses 6 on average, to wait 1, to stop nothing."""


DEAR = {
    "dear.ef": """project: dear
horizon: 10
discount: 0.95

state_variable: bool is_late

initial_belief:
state.is_late = AOS.Bernoulli(0.5);
""",
    "pay.sd": """project: dear
parameter: int price

available_parameters_code:
for (int price = 1; price <= 200; price++) __possibleParameters.push_back(std::make_tuple(price));

dynamic_model:
__reward = -price;
state__.is_late = AOS.Bernoulli(0.5);
__moduleResponse = done;
""",
}
"""Two hundred actions, all of which cost."""


async def test_the_same_seed_and_simulations_give_the_same_decision():
    plans = []
    for _ in range(2):
        async with engine_of_bundle(BUNDLES / "bench" / "tag") as engine:
            plans.append(await engine.plan(simulations=1_000, seed=3, planner="despot"))
    assert plans[0].actions == plans[1].actions
    assert plans[0].planner == "despot"


async def test_the_tiger_is_listened_for_and_not_flattered():
    async with engine_of_bundle(BUNDLES / "bench" / "tiger") as engine:
        first = await engine.plan(simulations=5_000, seed=1, planner="despot")
        for _ in range(3):
            await engine.update("listen", "tiger_left")
        later = await engine.plan(simulations=5_000, seed=2, planner="despot")
    assert first.best.action == "listen"
    assert -20 < first.best.q < 19.4  # what always listening and what the best policy earn
    assert later.best.action == "open(door=right_door)"


async def test_a_model_that_cannot_be_enumerated_is_planned_by_rollouts():
    async with engine_of_text(COUNTER) as engine:
        plan = await engine.plan(simulations=5_000, seed=1, planner="despot")
        other = [await engine.plan(simulations=2_000, seed=1, planner=name) for name in ("auto", "sarsop")]
    assert plan.best.action == "stop"
    assert [chosen.planner for chosen in other] == ["pomcp", "pomcp"]
    assert all("states of the belief differ" in chosen.why for chosen in other)


async def test_a_belief_that_has_ended_needs_no_decision():
    async with engine_of_bundle(BUNDLES / "bench" / "rocksample-7-8") as engine:
        for _ in range(7):
            summary = (await engine.update("move(direction=east)", "moved")).summary
        assert summary.goal_probability == 1
        for planner in ("despot", "sarsop", "auto", "pomcp"):
            plan = await engine.plan(simulations=1_000, seed=1, threads=2, planner=planner)
            assert {action.q for action in plan.actions} == {0}, planner


async def test_an_action_that_was_not_tried_is_told_by_its_bound_and_not_chosen():
    async with engine_of_text(DEAR) as engine:
        within = Restriction(barred=[0, 1, 2])
        plan = await engine.plan(simulations=1, seed=1, planner="despot", within=within)
    untried = [action for action in plan.actions if action.n == 0]
    assert untried
    assert plan.best.n > 0
    assert plan.index not in within.barred
    for action in untried:
        assert action.at_most is not None
        assert action.q <= action.at_most < 0
