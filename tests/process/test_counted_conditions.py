import pytest
from models import engine_of_text
from wide.writing import BundleWriter

ENVIRONMENT = """horizon: 4
discount: 0.9

state_variable: float charge
state_variable: int place
state_variable: bool is_ready
state_variable: vector<int> doors

initial_belief:
state.charge = 1.5;
state.place = 2;
state.doors = vector<int>{1, 1, 0};

reward_code:
bool all = true;
for (const int& door : state.doors) if (door != 1) all = false;
if (state.charge && state.place && state.is_ready && all) { __reward = 10; __isGoalState = true; }
"""
NUMBERS_TEXTS_AND_POINTERS = """const char* text = state.place == 2 ? "two" : nullptr;
std::string name = text ? text : "";
if (text && name == "two" && state.charge && !state.is_ready) __reward = 1;
if (double charge = state.charge) { if (charge && name.empty() && text) __reward = 9; }
if (int place = state.place; place && state.charge && state.charge - 1 && text) __reward += 2;
if ((state.charge || text) && (state.place & 2 || text) && 0.5) __reward += state.is_ready ? 0 : 4;
"""
A_CONSTANT_EXPRESSION = """constexpr bool is_real = true && 1 + 1 == 2;
if (is_real && state.charge && state.place && !state.is_ready) __reward = 7;
"""


@pytest.mark.parametrize("code", [NUMBERS_TEXTS_AND_POINTERS, A_CONSTANT_EXPRESSION])
async def test_whatever_a_condition_is_made_of_its_reward_is_as_documented(code):
    writer = BundleWriter("counted", ENVIRONMENT)
    end = "state__.doors[2] = 1;\nstate__.is_ready = true;\n__moduleResponse = ok;\n"
    writer.skill("close", code + end)
    async with engine_of_text(writer.files) as engine:
        exact = await engine.exact_values(1)
    assert exact.values[0].q == pytest.approx(17)
