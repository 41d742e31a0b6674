"""The evidence of real runs about the state beyond the response, and the text of a state, in a running
engine."""

from collections.abc import AsyncIterator, Mapping

import pytest
from mappings import mapping_text
from models import built_text, engine_of, engine_of_bundle
from places import BUNDLES

from aos_protocol.messages import BeliefSummary
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

ENVIRONMENT = """project: rover
horizon: 4
discount: 0.95

define_type: Place
enum_members: Base, Hill, Lake

state_variable: Place at

state_variable: bool is_mapped

state_variable: float charge
code:
state.charge = 1;

state_variable: int heights []
code:
state.heights = {0, 0};

state_variable: bool tiles []
code:
state.tiles = {false, false};

state_variable: string note

state_variable: int visits

initial_belief:
state.is_mapped = AOS.Bernoulli(0.5);

reward_code:
if (state.at == Lake) {
    __reward = 10;
    __isGoalState = true;
}

reward_code:
if (state.at == Hill) {
    __reward = 1;
    __stopEvaluatingState = true;
}

print_code:
ss << state.at << " at " << state.charge << (state.is_mapped ? ", mapped" : "") << std::endl;
"""

DRIVE = """project: rover

dynamic_model:
state__.at = AOS.Bernoulli(0.5) ? Hill : Lake;
state__.visits = 1;
__moduleResponse = arrived;
__reward = -1;
state_given_observation:
if (slipped) state___.at = state__.at;
else if (place == "hill") state___.at = Hill;
else state___.at = Lake;
if (distances.size() > 2) state___.visits = distances[5];
if (tiles[2]) state___.visits = tiles.size();
state___.is_mapped = state__.is_mapped || AOS.Bernoulli(0.5);
"""

DRIVE_MAPPING = (
    mapping_text(
        "arrived: True",
        project="rover",
        skill="drive",
        reports={
            "slipped": "bool",
            "place": "string",
            "distances": "double[]",
            "charge": "float",
            "heights": "int[]",
            "tiles": "vector<bool>",
        },
    )
    + "\nlocal_variable: note\nfrom_ros_service_response: true\ncode:\nnote = __input.note\n"
)

LOOK = "project: rover\n\ndynamic_model:\n__moduleResponse = state.is_mapped ? known : unknown;\n"

ROVER = {"rover.ef": ENVIRONMENT, "drive.sd": DRIVE, "drive.am": DRIVE_MAPPING, "look.sd": LOOK}
SEEN = {
    "slipped": "false",
    "place": '"hill"',
    "distances": "[1.5,2]",
    "charge": "0.25",
    "heights": "[3,-4,5]",
    "tiles": "[true,false,true]",
    "note": '"sunny"',
}


@pytest.fixture
async def rover() -> BuiltModel:
    return await built_text(ROVER)


@pytest.fixture
async def engine(rover: BuiltModel) -> AsyncIterator[Engine]:
    async with engine_of(rover) as engine:
        yield engine


def values(belief: BeliefSummary, variable: str) -> Mapping[str, float]:
    return next(marginal.values for marginal in belief.marginals if marginal.variable == variable)


async def test_code_corrects_every_state_with_the_local_variables(engine: Engine):
    update = await engine.update("drive", "arrived", SEEN)
    assert update.remark == ""
    assert values(update.summary, "at") == {"Hill": 1.0}
    assert update.probability == pytest.approx(1.0)


async def test_a_local_variable_of_a_state_variables_name_and_type_tells_its_value(engine: Engine):
    belief = (await engine.update("drive", "arrived", SEEN)).summary
    assert values(belief, "charge") == {"0.25": 1.0}
    heights = [values(belief, f"heights[{index}]") for index in range(3)]
    assert heights == [{"3": 1.0}, {"-4": 1.0}, {"5": 1.0}]
    tiles = [values(belief, f"tiles[{index}]") for index in range(3)]
    assert tiles == [{"true": 1.0}, {"false": 1.0}, {"true": 1.0}]
    assert values(belief, "visits") == {"3": 1.0}
    assert "note" not in [marginal.variable for marginal in belief.marginals], "a constant: it has no type"


async def test_the_code_sees_the_state_before_the_step(engine: Engine):
    local_values = {**SEEN, "slipped": "true", "tiles": "[true,true,false]"}
    belief = (await engine.update("drive", "arrived", local_values)).summary
    assert values(belief, "at") == {"Base": 1.0}
    assert values(belief, "visits") == {"1": 1.0}


async def test_draws_of_the_code_are_enumerated_and_equal_states_merged(engine: Engine):
    belief = (await engine.update("drive", "arrived", SEEN)).summary
    assert belief.is_exact
    assert belief.states == 2
    assert values(belief, "is_mapped") == pytest.approx({"true": 0.75, "false": 0.25})


async def test_the_special_states_look_at_the_corrected_state(engine: Engine):
    at_hill = (await engine.update("drive", "arrived", SEEN)).summary
    assert at_hill.goal_probability == 0.0, "the model alone gives 0.5"
    await engine.reset_belief()
    at_lake = (await engine.update("drive", "arrived", {**SEEN, "place": '"lake"'})).summary
    assert at_lake.goal_probability == 1.0


async def test_a_special_state_that_counts_once_is_used_up_by_the_corrected_state_only(engine: Engine):
    await engine.update("drive", "arrived", {**SEEN, "slipped": "true"})
    exact = {value.action: value.q for value in (await engine.exact_values(1)).actions}
    assert exact["drive"] == pytest.approx(-1 + 0.5 * 10 + 0.5 * 1)


async def test_an_ended_state_stays_as_it_is(engine: Engine):
    await engine.update("drive", "arrived", {**SEEN, "place": '"lake"'})
    belief = (await engine.update("drive", "arrived", SEEN)).summary
    assert values(belief, "at") == {"Lake": 1.0}
    assert values(belief, "charge") == {"0.25": 1.0}


async def test_the_belief_of_a_simulation_is_that_of_the_model(engine: Engine):
    belief = (await engine.update("drive", "arrived")).summary
    assert values(belief, "at") == pytest.approx({"Hill": 0.5, "Lake": 0.5})


async def test_a_skill_without_such_code_is_updated_by_its_response_alone(engine: Engine):
    update = await engine.update("look", "known", {"found": "true"})
    assert update.remark == ""
    assert values(update.summary, "is_mapped") == {"true": 1.0}


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("slipped", "null", "slipped has no value"),
        ("slipped", "1", "slipped is 1, which is no bool"),
        ("place", "<Pose at 0x7f>", "place is <Pose at 0x7f>, which is no string"),
        ("distances", "[1.0,null]", "distances is [1.0,null], which is no double[]"),
        ("heights", "[2147483648]", "heights is [2147483648], which is no int[]"),
        ("charge", '"full"', 'charge is "full", which is no float'),
    ],
)
async def test_a_value_that_is_not_there_or_of_another_type_leaves_the_belief_to_the_response(
    engine: Engine, name, text, reason
):
    update = await engine.update("drive", "arrived", {**SEEN, name: text})
    assert update.remark == f"the local variables of drive do not correct the belief: {reason}"
    assert values(update.summary, "at") == pytest.approx({"Hill": 0.5, "Lake": 0.5})
    assert values(update.summary, "charge") == {"1": 1.0}


async def test_a_fault_of_the_code_is_told_at_its_place_and_leaves_the_belief_to_the_response(engine: Engine):
    update = await engine.update("drive", "arrived", {**SEEN, "distances": "[1,2,3]"})
    assert update.remark.endswith("drive.sd:12:27: element 5 of a vector of 3")
    assert values(update.summary, "at") == pytest.approx({"Hill": 0.5, "Lake": 0.5})


async def test_the_statement_of_the_same_fault_is_looked_for_once(engine: Engine, monkeypatch):
    faulty = {**SEEN, "distances": "[1,2,3]"}
    first = await engine.update("drive", "arrived", faulty)
    monkeypatch.delattr("aos_solver.child.questions.asking.at_its_statement")
    assert (await engine.update("drive", "arrived", faulty)).remark == first.remark


async def test_an_array_beyond_its_state_variables_room_is_told_by_name(engine: Engine):
    update = await engine.update("drive", "arrived", {**SEEN, "heights": str(list(range(500)))})
    assert "heights: a vector of" in update.remark
    assert values(update.summary, "heights[0]") == {"0": 1.0}


async def test_an_impossible_observation_is_dealt_with_as_without_local_variables(engine: Engine):
    update = await engine.update("drive", "capsized", SEEN)
    assert update.is_impossible
    assert values(update.summary, "charge") == {"1": 1.0}


async def test_a_simulated_state_is_shown_by_the_documents_print_function(engine: Engine):
    limits = MissionLimits(step_limit=1)
    run = await simulate_mission(engine, Search(simulations=100, seed=2), limits, with_states=True)
    assert len(run.states) == run.steps + 1
    assert run.states[0] in ("Base at 1\n", "Base at 1, mapped\n")


async def test_without_a_print_function_a_state_is_shown_by_its_variables():
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        await engine.reset_world(1)
        text = await engine.world_state()
    assert ", robot_at=HardTable, holding_can=false, " in text
