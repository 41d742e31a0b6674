import pytest
from models import engine_of_text

ODDS = (0.02, 0.5, 0.18, 0.3)
FIRST_ODDS = (0.25, 0.0, 0.7, 0.05)
WORTH = (1000, 10, -3, 0)
HORIZON = 3


def documents(move: str) -> dict[str, str]:
    """A die with four faces: a step earns what the face is worth, and one of two actions throws the die."""
    return {
        "die.ef": f"""project: die
horizon: {HORIZON}
discount: 0.5

state_variable: int face

state_variable: double height

state_variable: int throws

state_variable: int worth []
code:
state.worth = {{{", ".join(map(str, WORTH))}}};

initial_belief:
std::vector<double> odds = {{{", ".join(map(str, FIRST_ODDS))}}};
state.face = AOS.SampleDiscrete(odds);
""",
        "play.sd": f"""project: die
parameter: bool throws

available_parameters_code:
__possibleParameters.push_back(std::make_tuple(false));
__possibleParameters.push_back(std::make_tuple(true));

dynamic_model:
__reward = state.worth[state.face];
std::vector<double> odds = {{{", ".join(map(str, ODDS))}}};
if (throws) {{
    state__.face = AOS.SampleDiscrete(odds);
    {move}
}}
__moduleResponse = AOS.Bernoulli(0.9) == (state__.face < 2) ? low : high;
""",
    }


async def test_walks_by_the_table_earn_what_the_odds_say():
    first = sum(odds * worth for odds, worth in zip(FIRST_ODDS, WORTH, strict=True))
    thrown = sum(odds * worth for odds, worth in zip(ODDS, WORTH, strict=True))
    # The die has been thrown after half of the steps: what is left of the first face halves each time.
    means = [thrown + (first - thrown) * 0.5**step for step in range(HORIZON)]
    async with engine_of_text(documents("")) as engine:
        walked = await engine.rate(0.2, seed=1, stepping="table")
        assert walked.samples > 100_000
        assert walked.mean_reward == pytest.approx(sum(means) / HORIZON, rel=0.01)


@pytest.mark.parametrize(
    "move",
    [
        "state__.height = AOS.SampleNormal(0, 1);",
        "__reward = state__.throws++;",
        "if (AOS.Bernoulli(1e-12)) state__.face = state.worth.at(4);",
    ],
    ids=["a draw without end", "states without end", "a fault that hardly ever happens"],
)
async def test_there_is_no_table_of(move):
    async with engine_of_text(documents(move)) as engine:
        assert (await engine.rate(0.05, seed=1, stepping="table")).samples == 0
        assert (await engine.rate(0.05, seed=1)).samples > 0
