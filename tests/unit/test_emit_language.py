from typing import Any

import pytest
from mappings import mapping_text
from projects import text_project
from scripted_models import ScriptedModel, json_text, scripted


def skill_text(name: str, code: str | list[dict[str, Any]], **sections: Any) -> str:
    assignments = [{"AssignmentCode": code}] if isinstance(code, str) else code
    return json_text({"DynamicModel": {"NextStateAssignments": assignments}, **sections}, "PLP", name)


def loops(**loop: str) -> list[dict[str, str]]:
    return [{"Type": loop["over"], "ItemName": loop["item"], "ConditionCode": loop.get("where", ""),
             "WhenConditionTrueCode": loop.get("do", "")}]  # fmt: skip


ENVIRONMENT = json_text(
    {
        "EnvironmentGeneral": {"Horizon": 5, "Discount": 0.9},
        "GlobalVariableTypes": [
            {"TypeName": "tColour", "Type": "enum", "EnumValues": ["eRed", "eGreen", "eBlue"]},
            {"TypeName": "State", "Type": "enum", "EnumValues": ["start", "actions"]},
            {"TypeName": "tBox", "Type": "compound", "Variables": [
                {"Name": "lid", "Type": "tLid"},
                {"Name": "colour", "Type": "tColour", "Default": "eGreen"},
                {"Name": "weight", "Type": "float", "Default": "1.5f;"},
                {"Name": "label", "Type": "string", "Default": "\"none\""},
            ]},
            {"TypeName": "tLid", "Type": "compound", "Variables": [
                {"Name": "is_open", "Type": "bool", "Default": "true"},
                {"Name": "place", "Type": "anyValue"},
            ]},
        ],
        "GlobalVariablesDeclaration": [
            {"Name": "box_b", "Type": "tBox",
             "DefaultCode": "state.box_b.weight = 2; state.box_b.lid.place = ___shelf"},
            {"Name": "box_a", "Type": "tBox"},
            {"Name": "grid", "Type": "int", "IsArray": True, "DefaultCode": "state.grid={4,5,6};"},
            {"Name": "path", "Type": "vector<tColour>"},
            {"Name": "table", "Type": "vector<vector<int>>", "DefaultCode": "state.table = {{1,2,3},{4,5}};"},
            {"Name": "note", "Type": "string", "Default": "\"a;b\""},
            {"Name": "mode", "Type": "State", "Default": "actions;"},
            {"Name": "cost", "Type": "int", "Parameters": ["tColour", "(1,6,2)"],
             "IncludeParametersCode": "par1 != eBlue || par2 != 5",
             "DefaultCode": "state.cost[std::make_tuple(par1, par2)] = int(par1) * 10 + par2;"},
            {"Name": "sum", "Type": "int",
             "DefaultCode": "for (auto& c : state.cost) state.sum += c.second;"},
            {"Name": "known", "Type": "anyValue"},
            {"Name": "red", "Type": "tColour", "Default": "eRed", "IsActionParameterValue": True},
            {"Name": "blue", "Type": "tColour", "Default": "eBlue", "IsActionParameterValue": True},
            {"Name": "p_box", "Type": "tBox", "IsActionParameterValue": True,
             "DefaultCode": "state.p_box.label = \"big box\";"},
        ],
        "InitialBeliefStateAssignments": [
            {"AssignmentCode": "state.mode = AOS.SampleDiscrete(State, {0.5, 0.5});"},
            {"IteratePreviousStateVars": loops(over="tBox", item="box", where="box.weight > 1.8",
                                               do="box.weight = 3;")
             + loops(over="tBox", item="it", where="it.weight < box.weight", do="it.weight -= 0.5; break;")},
        ],
        "SpecialStates": [],
        "HeuristicStateValue": [{"AssignmentCode": "__heuristicValue = state.box_a.weight;"}],
        "ExtrinsicChangesDynamicModel": [],
    },
    "Environment",
    "environment",
)  # fmt: skip
LOW_LEVEL = json_text(
    {
        "LocalVariableTypes": [],
        "Constants": [{"Name": "___shelf", "Type": "int", "InitCode": "___shelf = 3"}],
    },
    "EnvironmentGlue",
    "environment",
)
SKILLS = {
    "paint": skill_text(
        "paint",
        [
            {"TempVar": {"VarName": "ending", "Type": "enum", "EnumName": "enumEnding",
                         "EnumValues": ["well", "badly", "never"]},
             "AssignmentCode": "ending = AOS.SampleDiscrete(enumEnding, {0.2, 0.3, 0.5});"},
            {"TempVar": {"VarName": "is_wet", "Type": "bool"},
             "AssignmentCode": "is_wet = ending == badly;"},
            {"IterateNextStateVars": loops(over="tBox", item="each", where="each.colour != colour",
                                           do="each.colour = colour; break;")},
            {"AssignmentCode": "if (is_wet) return; state__.sum = ending - enumEnding;"},
            {"AssignmentCode": "__reward = 1"},
        ],
        GlobalVariableModuleParameters=[
            {"Name": "colour", "Type": "tColour"}, {"Name": "box", "Type": "tBox"}
        ],
        Preconditions={"GlobalVariablePreconditionAssignments": [
            {"AssignmentCode": "__meetPrecondition = false;"},
            {"IteratePreviousStateVars": loops(over="tBox", item="b", where="b.weight > 2",
                                               do="b.weight = 0; __meetPrecondition = b.weight == 0;")},
        ]},
    ),
    "count": skill_text(
        "count",
        """int open = 0;
for (int i = 0; i < state__.tBoxObjects.size(); i++) if (state__.tBoxObjects[i]->lid.is_open) open++;
for (auto* box : state__.tBoxObjects) box->label = to_string(open) + "/" + string(box->label);
auto is_heavy = [&](const tBox* box) { return box->weight > 2; };
open += count_if(state.tBoxObjects.begin(), state.tBoxObjects.end(), is_heavy);
for (auto& named : state.tColourObjectsForActions) {
    if (named.second == eBlue && named.first == "state.blue") open += 10;
}
for (tColour c : state.tColourObjects) open += 100 * c;
state__.sum = open;""",
    ),
    "draw": skill_text(
        "draw",
        """enum Side { left, right };
enum Odd { three = 3, seven = 7 };
Side side = AOS.SampleDiscrete(Side, {0.5, 0.5});
vector<double> weights{0.25, 0.5};
int index = AOSUtils::SampleDiscrete(weights);
if (AOSUtils::Bernoulli(0.5)) {state__.box_a.colour = AOS.SampleDiscrete(tColour, {0.1, 0.9})}
state__.sum = side * 1000 + index * 100 + AOS.SampleDiscrete(Odd, {1, 1});
state__.box_a.weight = AOS.SampleNormal(0, 1) + AOS.SampleUniform(2, 3);
const auto& grid = state.grid;
int fixed[] = {2, 4};
state__.sum += 10000 * AOS.SampleDiscrete(state.grid, {1, 1, 1});
state__.sum += 100000 * AOS.SampleDiscrete(grid, {1, 1, 1});
state__.sum += 1000000 * AOS.SampleDiscrete(fixed, weights);
state__.sum += 10000000 * AOS.SampleDiscrete(vector<int>{2, 3}, {1, 1});
AOS.SetNull(state__.box_b.lid.place); __reward = AOS.IsInitialized(state.box_b.lid.place) ? 1 : 0;""",
    ),
    "shape": skill_text(
        "shape",
        """state__.grid.push_back(7);
state__.grid[0] += state.grid.at(1);
vector<int> copied = state__.grid;
sort(copied.begin(), copied.end());
state__.table[1] = {8, 9, 10};
state__.path = vector<tColour>(2, eBlue);
state__.note += "!";
string& note = state__.note;
note.insert(0, "_").erase(0, 1);
vector<int>& row = state__.grid;
row.at(1) = note == "a;b!" ? 50 : 51;
auto found = state__.cost.find(make_tuple(eBlue, 3));
if (found != state__.cost.end()) found->second = 99;
auto detached = *state__.cost.begin();
detached.second = -1;
for (auto& [key, value] : state__.cost) if (get<1>(key) == 5) value = -5;
state__.sum = copied.back() + state__.cost[{eRed, 1}] + state__.note.size();
__moduleResponseStr = state__.note + "__";
for (int i = 0; i < 2; i++) __moduleResponseStr[i] = 'X';""",
    ),
    "speak": skill_text(
        "speak",
        """AOS.Initialize(state__.known);
__moduleResponseStr = "a"; if (state.sum) return; __moduleResponseStr = "b";""",
    ),
    "fail": skill_text(
        "fail",
        """state__.grid[which] = 1;
if (which == 1) __reward = 1 / 0.0;
if (which == 2) __moduleResponse = 9;""",
        GlobalVariableModuleParameters=[{"Name": "which", "Type": "int"}],
        PossibleParametersValue=[{
            "AssignmentCode": "for (int i : {1, 2, 3, -1}) __possibleParameters.push_back(make_tuple(i))"
        }],
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def model() -> ScriptedModel:
    skills = {f"{name}.json": text for name, text in SKILLS.items()}
    others = {"environment.json": ENVIRONMENT, "glue.json": LOW_LEVEL, "fail.am": mapping_text()}
    return scripted(text_project(others | skills))


def test_values_have_their_declared_defaults(model: ScriptedModel):
    state = model.play(initial="0").initial["state"]
    assert state["box_a.colour"] == "eGreen"
    assert state["box_a.label"] == "none"
    assert state["box_b.lid.place"] == "true"
    assert [state[f"grid[{index}]"] for index in range(3)] == ["4", "5", "6"]
    assert [state["table[1][0]"], state["table[1][1]"]] == ["4", "5"]
    assert state["note"] == "a;b"
    assert state["cost[eBlue,3]"] == "23"
    assert state["cost[eBlue,5]"] == "0"
    assert state["sum"] == str(3 * (1 + 3 + 5) + 3 * (0 + 10 + 20) - 25)


def test_an_initial_belief_may_draw_an_enum_and_change_what_it_iterates_over(model: ScriptedModel):
    played = model.play(initial="1")
    assert played.initial["state"]["box_b.weight"] == "3"
    assert played.initial["state"]["box_a.weight"] == "1"


def test_groundings_are_ordered_by_variable_name_and_the_first_parameter_is_outermost(model: ScriptedModel):
    actions = [name for name in model.describe() if name.startswith("paint")]
    assert actions == ["paint(colour=blue, box=p_box)", "paint(colour=red, box=p_box)"]
    assert model.describe()["paint(colour=blue, box=p_box)"] == {
        "colour": "eBlue",
        "box": {
            "lid": {"is_open": True, "place": False}, "colour": "eGreen", "weight": 1.5, "label": "big box"
        },
    }  # fmt: skip


def test_loops_run_over_declared_variables_in_order_and_change_only_what_they_may(model: ScriptedModel):
    played = model.play("paint(colour=blue, box=p_box)|0")
    assert played.values("box_b.colour") == ["eGreen", "eBlue"]
    assert played.values("box_a.colour") == ["eGreen", "eGreen"]
    assert played.steps[0]["meets_precondition"] is True
    assert played.values("box_b.weight") == ["3", "3"]


def test_the_name_of_a_temporary_enum_stands_before_its_first_value(model: ScriptedModel):
    assert model.play("paint(colour=red, box=p_box)|2").values("sum")[1] == "3"


def test_return_ends_the_dynamic_model_early(model: ScriptedModel):
    assert model.play("paint(colour=red, box=p_box)|1").rewards == [0]
    assert model.play("paint(colour=red, box=p_box)|0").rewards == [1]


def test_a_text_that_was_set_before_return_is_the_response(model: ScriptedModel):
    assert model.play("speak").observations == ["a"]


def test_lists_of_objects_read_like_vectors_of_pointers(model: ScriptedModel):
    played = model.play("count")
    assert played.values("sum")[1] == str(2 + 1 + 10 + 100 + 200)
    assert played.values("box_b.label") == ["none", "2/none"]


def test_draws_over_declared_local_and_numbered_enums_and_over_lists(model: ScriptedModel):
    played = model.play("draw|1 1 1 2 1 0.25 2.5 1 2 1 1")
    assert played.values("sum")[1] == str(1107 + 50000 + 600000 + 4000000 + 30000000)
    assert played.values("box_a.colour")[1] == "eBlue"
    assert played.values("box_a.weight")[1] == "2.75"


def test_a_value_without_meaning_here_can_be_set_and_asked_for(model: ScriptedModel):
    played = model.play("draw", "draw")
    assert played.rewards == [1, 0]


def test_a_variable_that_only_initialize_changes_is_no_constant(model: ScriptedModel):
    assert model.play("speak").values("known") == ["false", "true"]


def test_containers_take_what_documents_do_with_the_standard_ones(model: ScriptedModel):
    played = model.play("shape")
    state = played.steps[0]["state"]
    assert [state[f"grid[{index}]"] for index in range(4)] == ["9", "50", "6", "7"]
    assert [state[f"table[1][{index}]"] for index in range(3)] == ["8", "9", "10"]
    assert [state["path[0]"], state["path[1]"]] == ["eBlue", "eBlue"]
    assert state["cost[eBlue,3]"] == "99"
    assert state["cost[eRed,1]"] == "1"
    assert {state[f"cost[{colour},5]"] for colour in ("eRed", "eGreen", "eBlue")} == {"-5"}
    assert state["sum"] == str(9 + 1 + 4)
    assert played.observations == ["XXb!__"]
    assert played.steps[0]["is_saved"]


@pytest.mark.parametrize(
    ("action", "code", "text"),
    [
        ("fail(which=3)", "AOS215", "element 3 of a vector of 3"),
        ("fail(which=-1)", "AOS215", "element -1 of a vector of 3"),
        ("fail(which=1)", "AOS214", "the reward is inf, and no number from -1e+100 to 1e+100"),
        ("fail(which=2)", "AOS215", "__moduleResponse is 9, which is no response"),
    ],
)
def test_a_fault_of_model_code_names_its_piece(model: ScriptedModel, action, code, text):
    fault = model.fault(action)
    assert (fault["fault"], fault["text"]) == (code, text)
    assert model.emitted.snippets[fault["piece"] - 1].file == "fail.json"
