from exam.bundles import told_of_bundle
from models import engine_of_text
from texts import write_texts

OPEN = """project: boxes
parameter: int box

available_parameters_code:
for (int i = 0; i < 40; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
__reward = -1;
state__.left -= state.full[box];
__moduleResponse = state.full[box] ? found : nothing;
state__.full[box] = false;
"""
COINS = {
    "coins.ef": """project: boxes
horizon: 40
discount: 0.95

state_variable: bool full []
code:
state.full.assign(40, false);

state_variable: int left
code:
state.left = 4;

initial_belief:
for (int i = 0; i < 4; i++) {
    int box = AOSUtils::SampleDiscrete(vector<double>(40, 1.0 / 40));
    while (state.full[box]) box = (box + 1) % 40;
    state.full[box] = true;
}

reward_code:
if (state.left == 0) {
    __reward = 10;
    __isGoalState = true;
}
""",
    "open.sd": OPEN,
}
"""Four of 40 boxes hold a coin, and an opening costs 1: the coins that are left say what a state is worth."""

JAMMING_COINS = {
    **COINS,
    "coins.ef": COINS["coins.ef"].replace(
        "state_variable: int left",
        "state_variable: bool opened []\ncode:\nstate.opened.assign(40, false);\n\nstate_variable: int left",
    ),
    "open.sd": OPEN.replace(
        "dynamic_model:\n",
        "precondition:\n__meetPrecondition = !state.opened[box];\nviolate_penalty: -20\n\n"
        "dynamic_model:\nstate__.opened[box] = true;\n",
    ),
}
"""The same boxes, of which none is to be opened twice."""

SHELVES = {
    "shelves.ef": """project: shelves
horizon: 40
discount: 0.95

state_variable: int at
state_variable: bool full []
code:
state.full.assign(16, false);

initial_belief:
for (int i = 0; i < 16; i++) state.full[i] = AOS.Bernoulli(0.5);
""",
    "go.sd": """project: shelves
parameter: int by

available_parameters_code:
__possibleParameters.push_back(std::make_tuple(-1));
__possibleParameters.push_back(std::make_tuple(1));

dynamic_model:
state__.at = std::clamp(state.at + by, 0, 15);
__moduleResponse = nothing;
""",
    "look.sd": """project: shelves
parameter: int shelf

available_parameters_code:
for (int i = 0; i < 16; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
__reward = -0.1;
__moduleResponse = state.full[shelf] == AOS.Bernoulli(0.8) ? found : nothing;
""",
    "take.sd": """project: shelves

dynamic_model:
__reward = state.full[state.at] ? 10 : -10;
__moduleResponse = state.full[state.at] ? found : nothing;
state__.full[state.at] = false;
""",
}
"""A robot before 16 shelves: a million states. Looks at all shelves lead to the same states."""


async def _why(documents: dict[str, str]) -> str:
    async with engine_of_text(documents) as engine:
        return (await engine.plan(simulations=500, seed=3, planner="pomcp")).why


async def test_values_of_a_million_states_are_computed():
    why = await _why(SHELVES)
    assert f"without observations all {16 * 2**16} can be" in why


async def test_values_are_learned_where_tables_of_few_variables_hold_them_and_with_the_same_seed_the_same():
    plans = []
    for _ in range(2):
        async with engine_of_text(COINS) as engine:
            plans.append(await engine.plan(simulations=500, seed=3, planner="pomcp"))
    assert "what states are worth is learned" in plans[0].why
    assert plans[0].actions == plans[1].actions


async def test_what_missions_return_is_told_where_values_are_learned(tmp_path):
    """The tree promises that all is seen, some 20 more than a robot earns that has to open box after box."""
    write_texts(COINS, tmp_path)
    told = await told_of_bundle(tmp_path, "pomcp", missions=1, seed=1, seconds=None, simulations=300)
    assert told.returned < -10
    assert abs(told.value - told.returned) < 6
    assert abs(told.value - told.returned) < 2 * told.error


async def test_played_missions_never_take_what_everybody_knows_not_to_be_possible(tmp_path):
    """A state that is left without others to choose for it takes an action whose precondition holds."""
    assert "what states are worth is learned" in await _why(JAMMING_COINS)
    write_texts(JAMMING_COINS, tmp_path)
    told = await told_of_bundle(tmp_path, "pomcp", missions=1, seed=1, seconds=None, simulations=300)
    assert -20 < told.returned < -5
    assert abs(told.value - told.returned) < 10
    assert told.error < 20
