import pytest
from models import engine_of_text

from aos_protocol.errors import DocumentError, IntractableError

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


NOTHING = {
    "odd.ef": MANY["odd.ef"],
    "dig.sd": """project: odd
parameter: int cell

available_parameters_code:
for (int cell = 0; cell < 0; cell++) __possibleParameters.push_back(std::make_tuple(cell));

dynamic_model:
__moduleResponse = done;
""",
}


async def test_a_short_question_is_answered_after_one_that_went_over_the_limit():
    async with engine_of_text(MANY) as engine:
        with pytest.raises(IntractableError):
            await engine.exact_values(3)
        (value,) = (await engine.exact_values(1)).actions
    assert value.q == pytest.approx(0.5)


async def test_a_model_without_an_action_is_refused():
    with pytest.raises(DocumentError) as error:
        async with engine_of_text(NOTHING):
            pass
    assert error.value.code == "AOS119"
