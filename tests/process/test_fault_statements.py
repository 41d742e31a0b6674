import json

import pytest
from models import built_text, engine_of, engine_of_text
from processes import COMMAND_S

from aos_protocol.errors import ModelError
from aos_solver.building.build import BuiltModel
from aos_solver.child.blame import replay

WARD = """project: ward
horizon: 4

define_type: tFault
enum_members: eNone, eNull, eRange, eThrow, eReward, eVast, eResponse, eLambda, eShared, eOwn, eEmpty, \
eFirst, eMost

shared_code:
int bed_of(const auto& state__, int i) {
    const int index = i + 2;
    return state__.beds[index];  // eShared
}
constexpr int twice(int n) { return 2 * n; }

state_variable: int rooms
state_variable: int[] beds
code:
state.beds = {1, 2, 3};
state_variable: bool is_open
"""

# The statement of each fault has its name in a comment.
SLIP = """project: ward
parameter: tFault fault

available_parameters_code:
for (tFault fault : state.tFaultObjects)
    __possibleParameters.push_back(make_tuple(fault));

dynamic_model:
// Nothing is wrong up to here.
auto bed = [&](int i) {
    int index = i * 2;
    return state__.beds[index];  // eLambda
};
state__.rooms += bed(0);
if (fault == eNull) {
    int* nothing = nullptr;
    state__.rooms = *nothing;  // eNull
} else if (fault == eRange)
    state__.beds[7] = 1;  // eRange
switch (fault) {
    case eThrow:
        state__.is_open = true;
        throw runtime_error("no way");  // eThrow
    case eLambda:
        state__.rooms = bed(3);
        break;
    case eOwn: {
        vector<int> own{1, 2, state__.rooms};
        state__.rooms = own[own.size()];  // eOwn
        break;
    }
    case eEmpty: {
        struct Shelf { vector<int> cups; } shelf;
        shelf.cups.pop_back();  // eEmpty
        break;
    }
    case eFirst: {
        vector<int> none;
        state__.rooms = *none.begin();  // eFirst
        break;
    }
    case eMost:
        state__.beds.clear();
        state__.rooms = *std::max_element(state__.beds.begin(), state__.beds.end());  // eMost
        break;
    case eShared:
        state__.rooms = bed_of(state__, twice(2));
        break;
    default:
        break;
}
for (int i = 0; i < 3; ++i) {
    __reward += 1;
    if (fault == eReward && i == 2) __reward = 1.0 / (i - 2);  // eReward
    if (fault == eVast) __reward = 1e101;  // eVast
    __reward -= 1;
}
__moduleResponse = ok;
if (fault == eResponse)
    __moduleResponse = 9;  // eResponse
"""
FAULTS = {
    "eNull": ("AOS210", "signal 11, as for an index out of range or a pointer"),
    "eRange": ("AOS215", "element 7 of a vector of 3"),
    "eThrow": ("AOS215", "no way"),
    "eReward": ("AOS214", "the reward is inf"),
    "eVast": ("AOS214", "the reward is 1e+101, and no number from -1e+100 to 1e+100"),
    "eResponse": ("AOS215", "__moduleResponse is 9"),
    "eLambda": ("AOS215", "element 6 of a vector of 3"),
    "eShared": ("AOS215", "element 6 of a vector of 3"),
    "eOwn": ("AOS215", "element 3 of a vector of 3"),
    "eEmpty": ("AOS215", "element 0 of a vector of 0"),
    "eFirst": ("AOS215", "element 0 of a vector of 0"),
    "eMost": ("AOS215", "element 0 of a vector of 0"),
}


@pytest.fixture(autouse=True)
def _has_time(monkeypatch):
    monkeypatch.setattr(replay, "REPLAY_DEADLINE_S", COMMAND_S)


def line_of(text: str, mark: str) -> int:
    return next(number for number, line in enumerate(text.splitlines(), 1) if f"// {mark}" in line)


def in_json(sdl: str) -> str:
    """The skill `trip`, which does the same, in the other dialect: its code as arrays of lines."""
    parameters, _, effect = sdl.partition("available_parameters_code:\n")[2].partition("\ndynamic_model:\n")
    blocks = [
        [{"AssignmentName": "code", "AssignmentCode": code.splitlines()}] for code in (parameters, effect)
    ]
    return json.dumps(
        {
            "PlpMain": {"Project": "ward", "Name": "trip", "Type": "PLP", "Version": 1},
            "GlobalVariableModuleParameters": [{"Name": "fault", "Type": "tFault"}],
            "PossibleParametersValue": blocks[0],
            "DynamicModel": {"NextStateAssignments": blocks[1]},
        },
        indent=2,
    )


DOCUMENTS = {"slip.sd": SLIP, "trip.json": in_json(SLIP)}
BUNDLE = {"ward.ef": WARD, **DOCUMENTS}


async def fault_of(built: BuiltModel, skill: str, name: str) -> ModelError:
    async with engine_of(built) as running:
        actions = [action.name for action in running.description.actions]
        await running.reset_world(1)
        await running.step_world(actions.index(f"{skill}(fault=eNone)"))
        with pytest.raises(ModelError) as caught:
            await running.step_world(actions.index(f"{skill}(fault={name})"))
    return caught.value


@pytest.mark.parametrize(
    ("name", "document"),
    [*((name, "slip.sd") for name in FAULTS), ("eLambda", "trip.json"), ("eResponse", "trip.json")],
)
async def test_a_fault_is_told_at_its_statement(name, document):
    fault = await fault_of(await built_text(BUNDLE), document.partition(".")[0], name)
    (diagnostic,) = fault.diagnostics
    code, message = FAULTS[name]
    file, text = ("ward.ef", WARD) if name == "eShared" else (document, DOCUMENTS[document])
    assert (diagnostic.span.file, diagnostic.span.line) == (file, line_of(text, name))
    assert fault.code == code
    assert message in fault.message


BOARD = """project: board
horizon: 4

define_type: Mark
enum_members: None, Ours, Theirs

state_variable: Mark[] cells
code:
state.cells = {None, None, None};
state_variable: int unrelated
code:
state.unrelated = 7;

extrinsic_code:
int cell = 0;
while (state_.cells[cell] != None) {  // on a full board
    cell = (cell + 1) % 3;
}
state_.cells[cell] = Theirs;
"""
DRAW = """project: board

dynamic_model:
for (int i = 0; i < 3; i++) {
    if (state__.cells[i] == None) { state__.cells[i] = Ours; break; }
}
__moduleResponse = drawn;
"""


async def test_a_loop_that_cannot_end_is_told_with_the_state_in_which_it_cannot():
    async with engine_of_text({"board.ef": BOARD, "draw.sd": DRAW}) as running:
        await running.reset_world(1)
        await running.step_world(0)  # Theirs, then ours; with their second mark the board is full.
        await running.step_world(0)
        with pytest.raises(ModelError) as caught:
            await running.step_world(0)
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.span.file, diagnostic.span.line) == ("board.ef", line_of(BOARD, "on a full board"))
    message, _, values = diagnostic.message.partition(", with ")
    assert message == "this code does not come to an end"
    marks = sorted(value.partition("=")[2] for value in values.split(", "))
    assert marks == ["Ours", "Theirs", "Theirs"]
    assert values.startswith("state_.cells[0]=")
