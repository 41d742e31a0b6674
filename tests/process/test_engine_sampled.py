import pytest
from models import engine_of_text

GAUGE = {
    "gauge.ef": """project: gauge
horizon: 5
discount: 0.95

state_variable: double level

initial_belief:
state.level = AOS.SampleNormal(0, 1);
""",
    "read.sd": """project: gauge

dynamic_model:
__reward = -1;
if (state__.level + AOS.SampleNormal(0, 1) > 0) __moduleResponse = high;
else __moduleResponse = low;
""",
}
"""A level that is never seen, only its sign under noise of the same size."""

TEMPTING = GAUGE | {
    "leap.sd": """project: gauge

precondition:
__meetPrecondition = state.level > 100;
violate_penalty: -100

rollout_policy:
__heuristicValue = 10;

dynamic_model:
__moduleResponse = high;
"""
}
"""The only skill that play-outs prefer cannot be run."""


async def test_readings_of_an_unseen_level_agree_as_two_correlated_normals_do():
    async with engine_of_text(GAUGE) as engine:
        first = await engine.update("read", "high")
        plan = await engine.plan(simulations=1000, seed=1, planner="pomcp")
        second = await engine.update("read", "high")
    assert not first.summary.is_exact
    assert first.probability == pytest.approx(1 / 2, abs=0.03)
    # Two standard normals with correlation 1/2 have the same sign with probability 2/3.
    assert second.probability == pytest.approx(2 / 3, abs=0.03)
    assert plan.predicted[0].probability == pytest.approx(2 / 3, abs=0.03)


async def test_rollouts_leave_out_what_cannot_be_run_whatever_the_policy_weighs():
    async with engine_of_text(TEMPTING) as engine:
        plan = await engine.plan(simulations=2, seed=1, planner="pomcp")
    values = {value.action: value for value in plan.actions}
    assert (values["leap"].n, values["read"].n) == (1, 1)
    read = values["read"]
    # The value is moved by half of what the search has gained, and the error is the other half.
    five_readings = -(1 - 0.95**5) / 0.05
    assert read.q - read.stderr == pytest.approx(five_readings), "five readings, no leap"


PREJUDICED = GAUGE | {
    "read.sd": """project: gauge

rollout_policy:
__heuristicValue = 1;

dynamic_model:
state__.level = AOS.SampleNormal(0, 1);
__reward = state__.level > 0 ? -1 : -3;
if (state__.level > 0) __moduleResponse = high;
else __moduleResponse = low;
""",
    "leap.sd": """project: gauge

dynamic_model:
state__.level = AOS.SampleNormal(0, 1);
__reward = {leap};
__moduleResponse = high;
""",
}
"""Play-outs only ever read, which costs 2 on average; no state is worth more than another."""


@pytest.mark.parametrize(("leap", "best"), [("-3", "read"), ("-1", "leap")])
async def test_the_rollout_policy_guides_the_search_and_does_not_bind_it(leap, best):
    files = PREJUDICED | {"leap.sd": PREJUDICED["leap.sd"].format(leap=leap)}
    async with engine_of_text(files) as engine:
        plan = await engine.plan(simulations=10_000, seed=1, planner="pomcp")
    assert plan.best.action == best
    five_steps = (1 - 0.95**5) / 0.05
    if best == "read":  # which costs 2, and is what play-outs do
        assert plan.best.q == pytest.approx(-2 * five_steps, abs=0.15)
    else:  # which costs 1; the last of five may still be a reading, and no more than two
        assert -five_steps - 0.95**3 - 0.95**4 - 0.15 < plan.best.q < -five_steps + 0.15


async def test_what_holds_in_every_particle_is_certain_whatever_their_weights_sum_up_to():
    counted = (
        "state_variable: int hour\nextrinsic_code:\nstate_.hour++;\n"
        "reward_code:\nif (state.hour >= 5) __isGoalState = true, __reward = 1;\n"
    )
    files = {**GAUGE, "gauge.ef": GAUGE["gauge.ef"].replace("initial_belief", f"{counted}\ninitial_belief")}
    async with engine_of_text(files, seed=2) as engine:
        for response in ("high", "low", "high", "high"):
            before = await engine.update("read", response)
            assert before.summary.goal_probability == 0
        after = await engine.update("read", "low")
        assert not after.summary.is_exact
        assert after.summary.goal_probability == 1
