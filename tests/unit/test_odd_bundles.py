"""Two bundles full of odd but legal spellings: they load, compile, and mean what they say."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from scripted_models import ScriptedModel, bundle_project, scripted

from aos_language.load import load_bundle

CARRY = "carry(oTo={{side={side}, slots=[0, 0, 0], x={x}, full=false, label=, size=3}}, how={how}, step=left)"
TO_THE_RIGHT = CARRY.format(side="right", x="4", how=1)
TO_SHELF_A = CARRY.format(side="left", x="2.5", how=0)


@pytest.fixture(scope="module")
def warehouse(root: Path, cache_dir: Path) -> ScriptedModel:
    return scripted(bundle_project(root / "tests/data/bundles/warehouse"), cache_dir)


@pytest.fixture(scope="module")
def orchard(root: Path, cache_dir: Path) -> ScriptedModel:
    return scripted(bundle_project(root / "tests/data/bundles/orchard"), cache_dir)


def picked(state: Mapping[str, Any], *names: str) -> list[Any]:
    return [state[name] for name in names]


@pytest.mark.parametrize("bundle", ["warehouse", "orchard"])
def test_odd_spellings_are_told_and_none_is_an_error(root: Path, bundle):
    loaded = load_bundle(root / "tests/data/bundles" / bundle)
    assert loaded.project is not None
    codes = {"AOS122", "AOS124", "AOS125", "AOS127", "AOS137", "AOS140"}
    assert {finding.code for finding in loaded.diagnostics} <= codes


def test_odd_bundles_walk_a_thousand_steps(warehouse: ScriptedModel, orchard: ScriptedModel):
    assert warehouse.walk(1000)["steps"] == 1000
    assert orchard.walk(1000)["steps"] == 1000


# --- AOS 1.x JSON ---


def test_defaults_and_draws_of_json_set_the_first_state(warehouse: ScriptedModel):
    state = warehouse.play(initial="1 2 0").initial["state"]
    assert picked(state, "robot.at.label", "data", "index", "board[2]") == ["dock;1", "start!", "1", "X"]
    assert picked(state, "shelves[2].x", "shelves[1].side", "matrix[1][1]") == ["2", "right", "5"]
    assert picked(state, "map[left,2]", "map[none,2]") == ["3", "2"]
    assert picked(state, "pairs[left,right]", "pairs[left,left]") == ["7", "0"]


def test_a_long_dynamic_model_of_json_does_every_line(warehouse: ScriptedModel):
    played = warehouse.play(f"{TO_THE_RIGHT}|0 1 0 1", "wait_a_bit|3", initial="1 2 0")
    state = played.steps[0]["state"]
    assert picked(state, "robot.at.x", "robot.at.side", "robot.count", "robot.battery") == [
        "4", "right", "2", "0.99",
    ]  # fmt: skip
    assert picked(state, "shelf1.size", "shelf2.full", "shelf2.slots[0]", "shelves[0].x") == [
        "4", "true", "4", "0.5",
    ]  # fmt: skip
    # The first free cell was marked; then 7 and 8 changed places, and the board was turned round.
    assert [name for name, value in state.items() if value == "X"] == ["board[6]", "board[8]"]
    assert picked(state, "index", "distance", "data", "turn") == ["2", "7.25", "start!-1", "false"]
    assert picked(state, "map[left,2]", "map[right,0]", "constants") == ["4", "-1", "1"]
    assert played.rewards == [-7.25 / 2, -0.1]
    assert played.observations == ["eSuccess", "??????X?X"]


def test_return_within_an_assignment_ends_the_skills_model(warehouse: ScriptedModel):
    played = warehouse.play("wait_a_bit", "wait_a_bit|3", f"{TO_SHELF_A}|3", initial="1 2 0")
    assert played.steps[1]["meets_precondition"] is True
    refused = warehouse.play(f"{TO_THE_RIGHT}|0 1 0 1", f"{TO_SHELF_A}|3", initial="1 2 0").steps[1]
    assert refused["meets_precondition"] is True  # `return` left the verdict as it was.
    assert refused["observation"] == "eSuccess"


def test_an_extrinsic_change_marks_a_cell_by_a_temporary_enum(warehouse: ScriptedModel):
    played = warehouse.play("wait_a_bit|0", "wait_a_bit|1", initial="1 2 0")
    assert [step["observation"] for step in played.steps] == ["??X??????", "?OX??????"]
    assert played.rewards[1] == pytest.approx(-0.6)


# --- SDL ---


def test_defaults_and_draws_of_sdl_set_the_first_state(orchard: ScriptedModel):
    state = orchard.play(initial="2 2 1").initial["state"]
    assert picked(state, "windy", "first.ripe", "second.ripe", "second.x") == ["true", "2", "1", "3"]
    assert picked(state, "first.name", "second.name", "row[2].fruit") == [
        "old; tree",
        "no name; yet",
        "quince",
    ]
    assert picked(state, "first.branches[2]", "at", "log") == ["3", "0", ""]


def test_listed_parameters_of_text_are_text(orchard: ScriptedModel):
    actions = orchard.describe()
    assert actions["pick(fruit=apple, hand=left)"] == {"fruit": "apple", "hand": "left"}
    assert len(actions) == 3 * 2 + 2


def test_a_pointer_that_waits_for_its_object_finds_it(orchard: ScriptedModel):
    played = orchard.play("pick(fruit=apple, hand=right)", "pick(fruit=quince, hand=left)", initial="2 2 1")
    state = played.steps[0]["state"]
    assert picked(state, "first.ripe", "basket.content[0]", "basket.last.name") == ["1", "apple", "old; tree"]
    assert played.rewards == [1.25, -1]


def test_an_enum_goes_into_a_text_as_its_number(orchard: ScriptedModel):
    played = orchard.play("pick(fruit=pear, hand=left)", "pick(fruit=quince, hand=left)", initial="2 2 1")
    assert played.observations == ["Left:1x1", "Nothing"]


def test_the_last_of_two_sections_counts_and_its_lines_break_where_they_like(orchard: ScriptedModel):
    played = orchard.play("walk(speed=fast)|1 0 1 0", "walk(speed=slow)|1", initial="2 2 1")
    assert played.observations == ["tripped", "arrived"]
    assert played.values("log") == ["", "ouch 0", "walked 2"]
    assert picked(played.steps[1]["state"], "paths[0][0]", "paths[0][1]") == ["1", "2"]
    assert played.values("windy") == ["true", "false", "false"]
    assert played.values("row[0].branches[2]") == ["3", "0", "1"]
    assert played.rewards == [-0.5 - 1.0, 1 - 0.5]
