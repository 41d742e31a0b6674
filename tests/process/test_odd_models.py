import pytest
from models import engine_of_text

from aos_protocol.errors import DocumentError, IntractableError

CROWDED = {
    "odd.ef": "project: odd\nhorizon: 5\ndiscount: 0.9\n\n"
    + "".join(f"state_variable: int count_{number}\n\n" for number in range(100))
    + "state_variable: int cells []\ncode:\nstate.cells.assign(1000, 0);\n\n"
    "initial_belief:\nstate.cells[AOS.Bernoulli(0.5) ? 7 : 8] = 1;\n",
    "dig.sd": """project: odd
parameter: int cell

available_parameters_code:
for (int cell = 0; cell < 1000; cell++) __possibleParameters.push_back(std::make_tuple(cell));

dynamic_model:
__reward = state.cells[cell] == 1 ? 10 : -1;
state__.cells[cell] = 0;
state__.count_99 += 1;
__moduleResponse = done;
""",
}
"""1,000 actions, 100 variables, an array of 1,000 cells."""

SINGLE = {
    "odd.ef": """project: odd
horizon: 5
discount: 0.9

state_variable: int tosses

state_variable: bool is_hot

initial_belief:
state.is_hot = AOS.Bernoulli(0.3);
""",
    "toss.sd": """project: odd

dynamic_model:
state__.tosses = 0;
while (AOS.Bernoulli(0.5)) state__.tosses++;
__reward = state__.tosses;
__moduleResponseStr = state.is_hot ? "it is hot" : "it is cold";
""",
}
"""One action, texts as observations, and a loop that only chance ends."""

NOTHING = {"odd.ef": CROWDED["odd.ef"], "dig.sd": CROWDED["dig.sd"].replace("cell < 1000", "cell < 0")}
"""No action at all."""


async def test_a_thousand_actions_over_a_thousand_cells_are_told_apart():
    async with engine_of_text(CROWDED) as engine:
        assert len(engine.description.actions) == 1000
        plan = await engine.plan(simulations=20_000, seed=1, threads=2, planner="pomcp")
        assert plan.index in (7, 8)
        after = await engine.update(plan.best.action, "done")
    assert after.probability == pytest.approx(1)


MANY = {
    "odd.ef": "project: odd\nhorizon: 2\n\nstate_variable: int x\n\nstate_variable: int y\n",
    "go.sd": """project: odd

dynamic_model:
vector<double> all(800, 1 / 800.0);
state__.y = state.x;
state__.x = 1 + AOSUtils::SampleDiscrete(all);
__reward = (state__.x > 400) - (state.y > 900);
__moduleResponse = gone;
""",
}


async def test_a_short_question_is_answered_after_one_that_went_over_the_limit():
    async with engine_of_text(MANY) as engine:
        with pytest.raises(IntractableError):
            await engine.exact_values(3)
        (value,) = (await engine.exact_values(1)).actions
    assert value.q == pytest.approx(0.5)


async def test_one_action_with_texts_and_a_loop_without_a_bound_is_planned():
    async with engine_of_text(SINGLE) as engine:
        plan = await engine.plan(simulations=5_000, seed=1, planner="pomcp")
        assert plan.best.q == pytest.approx(1 + 0.9 + 0.81 + 0.729 + 0.6561, abs=0.3)
        assert {response.response for response in plan.predicted} == {"it is hot", "it is cold"}
        update = await engine.update("toss", "it is hot")
    marginals = {marginal.variable: marginal.values for marginal in update.summary.marginals}
    assert marginals["is_hot"] == {"true": pytest.approx(1)}


async def test_a_model_without_an_action_is_refused():
    with pytest.raises(DocumentError) as error:
        async with engine_of_text(NOTHING):
            pass
    assert error.value.code == "AOS119"
