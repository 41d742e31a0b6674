import math

import pytest
from models import engine_of_text

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
}


def fully_observable_value(cell: int) -> float:
    """Returns the value of walking on: V(c) = -1 + 0.95 (0.9 V(c + 1) + 0.1 V(c)); the step into the goal
    earns 50 at once."""
    value = (-1 + 0.9 * 50) / (1 - 0.95 * 0.1)
    for _ in range(8 - cell - 1):
        value = (-1 + 0.95 * 0.9 * value) / (1 - 0.95 * 0.1)
    return value


async def test_states_are_listed_without_what_is_observed_and_values_follow_from_them():
    async with engine_of_text(CORRIDOR) as engine:
        plan = await engine.plan(simulations=300, seed=1, planner="auto")
    assert plan.planner == "belief-tree"
    assert "all 7 states can be listed, but not what is observed: a draw is continuous" in plan.why
    assert plan.why.endswith("; their probabilities are estimated")
    expected = (fully_observable_value(1) + fully_observable_value(2)) / 2
    (walk,) = plan.actions
    assert walk.q == pytest.approx(expected, rel=0.02)
    # Without values of states, 300 play-outs would differ by more.
    assert walk.stderr < 1


DOORS = {
    "doors.ef": """project: doors
horizon: 12
discount: 0.95

define_type: Side
enum_members: Left, Right

action_parameter: Side left
code:
state.left = Left;

action_parameter: Side right
code:
state.right = Right;

state_variable: bool is_left

initial_belief:
state.is_left = AOS.Bernoulli(0.5);
""",
    "listen.sd": """project: doors
dynamic_model:
__reward = -1;
__moduleResponseStr = "";
for (int i = 0; i < 3; i++) {
    double heard = AOS.SampleNormal(state.is_left ? -1 : 1, 1.5);
    __moduleResponseStr += to_string(int(floor(4 * heard))) + ";";
}
""",
    "wait.sd": "project: doors\ndynamic_model:\n__reward = 0;\n",
    "open.sd": """project: doors
parameter: Side side
dynamic_model:
__reward = (side == Left) == state.is_left ? 10 : -100;
state__.is_left = AOS.Bernoulli(0.5);
""",
}


def _chance(reading: int, mean: float) -> float:
    """The probability of a reading of `DOORS`, which is four times a normal draw, rounded down."""
    edges = [(edge / 4 - mean) / 1.5 for edge in (reading, reading + 1)]
    return 0.5 * (math.erfc(-edges[1] / math.sqrt(2)) - math.erfc(-edges[0] / math.sqrt(2)))


@pytest.mark.parametrize("readings", [(7, -4, 7), (4, 6, 0), (-12, -3, 10), (10, 10, -10), (-1, 0, 1)])
async def test_beliefs_after_numbers_in_texts_are_those_of_bayes(readings):
    left, right = (math.prod(_chance(reading, mean) for reading in readings) for mean in (-1, 1))
    async with engine_of_text(DOORS) as engine:
        update = await engine.update("listen", "".join(f"{reading};" for reading in readings))
    marginal = next(
        marginal for marginal in update.summary.marginals if marginal.variable.endswith("is_left")
    )
    assert dict(marginal.values)["true"] == pytest.approx(left / (left + right), abs=0.03)
    assert (update.summary.effective_states or 0) > 1000


async def test_readings_that_are_written_as_numbers_are_paid_for():
    """Were all seen after one action, waiting would be better than listening."""
    async with engine_of_text(DOORS) as engine:
        plan = await engine.plan(simulations=4_000, seed=1, planner="auto")
        assert (plan.planner, plan.best.action) == ("belief-tree", "listen")
        again, other = [await engine.plan(simulations=4_000, seed=seed, planner="auto") for seed in (1, 2)]
    assert again.actions == plan.actions
    assert other.actions != plan.actions


async def test_responses_that_hardly_come_twice_leave_the_search_to_pomcp():
    words = """project: doors
dynamic_model:
__reward = -1;
double heard = AOS.SampleUniform(state.is_left ? 0 : 0.2, 1);
__moduleResponseStr = "";
for (int i = 0; i < 8; i++) {
    heard = 26 * (heard - floor(heard));
    __moduleResponseStr += char('a' + int(heard));
}
"""
    async with engine_of_text({**DOORS, "listen.sd": words}) as engine:
        plan = await engine.plan(simulations=500, seed=1, planner="auto")
    assert plan.planner == "pomcp"
    assert "; their probabilities cannot be estimated: hardly a response comes twice" in plan.why


async def test_pomcp_that_was_asked_for_stays_pomcp():
    async with engine_of_text(DOORS) as engine:
        plan = await engine.plan(simulations=500, seed=1, planner="pomcp")
    assert plan.planner == "pomcp"


async def test_sarsop_is_told_why_it_cannot_be_used():
    async with engine_of_text(CORRIDOR) as engine:
        plan = await engine.plan(simulations=50, seed=1, planner="sarsop")
    assert plan.planner == "pomcp"
    assert plan.why == "SARSOP cannot be used: a draw is continuous"


async def test_a_state_that_is_the_only_one_is_told_as_that():
    wait = "project: still\ndynamic_model:\n__moduleResponse = waited;\n"
    async with engine_of_text({"still.ef": "project: still\nhorizon: 2\n", "wait.sd": wait}) as engine:
        plan = await engine.plan(simulations=10, seed=1, planner="auto")
    assert plan.why.startswith("the only state can be listed")
