import json

import pytest
from dialects import say_the_same
from projects import files_project, text_project
from scripted_models import ScriptedModel, scripted

from aos_language.load import load_files
from aos_language.outline import outline
from aos_language.reading.document import array_type
from aos_protocol.diagnostics import Diagnostic

ENVIRONMENT = """project: shop
horizon: 5
define_type: Item
enum_members: Soda, Chips, Tea
define_type: Place
enum_members: Shelf, Table, Hand
define_type: Robot
variable: int seen [Item] 1
variable: bool heavy [Item] {true, false, true}
state_variable: Place at [Item]
default_value: Shelf
state_variable: float price [Item]
code:
state.price = {1.5, 2.5, 3};
state_variable: vector<int> rows [Item]
code:
state.rows[Tea] = {7, 8};
state_variable: Robot robot
action_parameter: Item soda
code:
state.soda = Soda;
initial_belief:
state.at[Tea] = AOS.Bernoulli(0.5) ? Table : Shelf;
reward_code:
if (state.at[Soda] == Hand) __reward = 1;
"""
TAKE = """project: shop
parameter: Item item
dynamic_model:
Place before = state.at[item];
state__.at[item] = Hand;
for (Item each : state.ItemObjects) state__.robot.seen[each] += state.at[each] == Table ? 10 : 0;
for (int i = 0; i < 3; i++) if (state__.robot.heavy[i]) state__.robot.seen[i]++;
vector<float> prices = state.price;
state__.price[1] = accumulate(prices.begin(), prices.end(), 0.0f);
state__.price[1] += count(state.at.begin(), state.at.end(), Shelf);
state__.rows[Tea].push_back(before);
__moduleResponse = before == Shelf ? taken : again;
"""
LATER = """project: shop
dynamic_model:
state__.at = {Table, Table};
"""
PUT = """project: shop
parameter: Place where
parameter: Item item
dynamic_model:
state__.at[item] = where;
"""
FILES = {"shop.ef": ENVIRONMENT, "take.sd": TAKE, "later.sd": LATER, "put.sd": PUT}


def files(**changed: str) -> dict[str, bytes]:
    """The bundle; `environment="OLD -> NEW"` replaces a text of the environment."""
    old, _, new = changed.get("environment", " -> ").partition(" -> ")
    assert old in ENVIRONMENT
    return {name: text.replace(old, new, 1).encode() for name, text in FILES.items()}


@pytest.fixture(scope="module")
def model() -> ScriptedModel:
    return scripted(text_project(FILES))


def errors(environment: str) -> list[Diagnostic]:
    return [finding for finding in load_files(files(environment=environment)).diagnostics if finding.is_error]


def test_elements_exist_from_the_start_and_have_the_names_of_the_enums_values(model: ScriptedModel):
    state = model.play(initial="1").initial["state"]
    assert [state[f"at[{item}]"] for item in ("Soda", "Chips", "Tea")] == ["Shelf", "Shelf", "Table"]
    assert [state[f"price[{item}]"] for item in ("Soda", "Chips", "Tea")] == ["1.5", "2.5", "3"]
    assert [state[f"robot.seen[{item}]"] for item in ("Soda", "Tea")] == ["1", "1"]
    assert [state[f"robot.heavy[{item}]"] for item in ("Soda", "Chips")] == ["true", "false"]
    assert [state["rows[Tea][0]"], state["rows[Tea][1]"]] == ["7", "8"]


def test_values_and_numbers_index_them_and_they_read_like_arrays(model: ScriptedModel):
    played = model.play("take(item=soda)", "take(item=soda)", initial="1")
    assert played.observations == ["taken", "again"]
    assert played.values("at[Soda]") == ["Shelf", "Hand", "Hand"]
    assert played.values("robot.seen[Tea]") == ["1", "12", "23"]
    assert played.values("robot.seen[Chips]") == ["1", "1", "1"]
    assert played.values("price[Chips]") == ["2.5", "9", "14.5"]
    assert played.steps[0]["state"]["rows[Tea][2]"] == "0"


def test_a_list_of_another_length_is_a_fault(model: ScriptedModel):
    fault = model.fault("later", initial="1")
    assert "a list of 2 for an array over an enum of 3 values" in json.dumps(fault)


def test_all_dialects_say_the_same():
    assert "variable Place[Item] at = Shelf" in outline(files_project(files()))
    as_json, sdl = say_the_same(files())
    assert b'"IndexedBy": "Item"' in as_json["environment.ef.json"]
    assert b"state_variable: Place at [Item]" in sdl["environment.ef"]


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("int", ("int", False, "")),
        ("int[]", ("int", True, "")),
        ("vector<int> [ Item ]", ("vector<int>", True, "Item")),
    ],
)
def test_the_type_of_an_array_says_its_index(written, read):
    assert array_type(written) == read


@pytest.mark.parametrize(
    ("change", "place", "hint"),
    [
        ("at [Item] -> at [Itm]", "shop.ef:10:27", "Did you mean `Item`?"),
        ("at [Item] -> at [Robot]", "shop.ef:10:27", "The enums are `Item`, `Place`"),
        ("seen [Item] -> seen [Robot]", "shop.ef:8:11", "The enums are `Item`, `Place`"),
        ("at[Soda] == -> at[Sodda] ==", "shop.ef:25:14", "Did you mean `Soda`?"),
        ("at[Soda] == -> at[ Table ] ==", "shop.ef:25:15", "The values of Item are `Soda`, `Chips`, `Tea`"),
        ("state.at[Soda] == Hand -> state.robot.seen[Hand] == 1", "shop.ef:25:22", "The values of Item are"),
    ],
)
def test_an_index_that_is_of_no_enum_or_of_another_is_an_error(change, place, hint):
    (error,) = errors(change)
    assert (error.code, str(error.span)) == ("AOS110", place)
    assert error.hint.startswith(hint)


def test_a_parameter_that_is_an_enum_has_all_values_where_none_are_declared(model: ScriptedModel):
    puts = {name: values for name, values in model.describe().items() if name.startswith("put")}
    assert list(puts) == [f"put(where={place}, item=soda)" for place in ("Shelf", "Table", "Hand")]
    assert model.play("put(where=Hand, item=soda)").values("at[Soda]") == ["Shelf", "Hand"]
