"""Influence through the items of `IterateNextStateVars` and `IteratePreviousStateVars`."""

from typing import Any

import pytest
from mappings import mapping_text
from projects import text_project
from scripted_models import json_text

from aos_protocol.documents import Project
from aos_solver.emission.lowering.relevance import (
    certain_rewards,
    irrelevant_variables,
    sensing_draws,
    skills_alike,
)

GARDEN = json_text(
    {
        "EnvironmentGeneral": {"Horizon": 3, "Discount": 0.9},
        "GlobalVariableTypes": [
            {
                "TypeName": "tPlant",
                "Type": "compound",
                "Variables": [{"Name": "id", "Type": "int"}, {"Name": "wet", "Type": "bool"}],
            }
        ],
        "GlobalVariablesDeclaration": [{"Name": "plant", "Type": "tPlant"}, {"Name": "rain", "Type": "bool"}],
        "SpecialStates": [{"StateConditionCode": "state.plant.wet", "Reward": 5.0, "IsGoalState": True}],
    },
    "Environment",
    "environment",
)


def watering(code: str, where: str, do: str, garden: str = GARDEN) -> Project:
    loop = {"Type": "tPlant", "ItemName": "p", "ConditionCode": where, "WhenConditionTrueCode": do}
    blocks: list[dict[str, Any]] = [{"AssignmentCode": line} for line in (code or "//").splitlines()]
    blocks.append({"IterateNextStateVars": [loop]})
    blocks.append({"AssignmentCode": "if (state.rain) __moduleResponse = dry;"})
    skill = {
        "GlobalVariableModuleParameters": [{"Name": "row", "Type": "int"}],
        "PossibleParametersValue": [
            {"AssignmentCode": "__possibleParameters.push_back(std::make_tuple(1));"}
        ],
        "DynamicModel": {"NextStateAssignments": blocks},
    }
    return text_project(
        {
            "environment.json": garden,
            "water.json": json_text(skill, "PLP", "water"),
            "water.am": mapping_text("done", "dry", skill="water"),
        }
    )


DRAWN = "bool hit = AOS.Bernoulli(0.5);"


@pytest.mark.parametrize(
    ("code", "where", "do"),
    [
        (DRAWN, "p.id == 1", "p.wet = hit;"),
        (DRAWN, "hit", "p.wet = true;"),
        (DRAWN, "p.id == 1", "if (hit) break; p.wet = true;"),
        ("", "AOS.Bernoulli(0.5)", "p.wet = true;"),
        ("", "p.id == 1", "p.wet = AOS.Bernoulli(0.5);"),
    ],
)
def test_a_draw_that_changes_an_item_shapes_the_state(code, where, do):
    project = watering(code, where, do)
    sensing = sensing_draws(project)
    assert not any(sensing.values())
    assert not certain_rewards(project, sensing)


def test_a_draw_beside_a_loop_that_only_observes_shapes_no_state():
    project = watering(DRAWN, "p.wet", "__moduleResponse = hit ? done : dry;")
    sensing = sensing_draws(project)
    assert any(sensing.values())
    assert certain_rewards(project, sensing) == skills_alike(project) == {"water"}


@pytest.mark.parametrize(
    ("code", "where", "do"),
    [
        ("", "p.id == row", "p.wet = true;"),
        ("", "", "p.wet = row > 1;"),
        ("int chosen = row;", "p.id == chosen", "p.wet = true;"),
    ],
)
def test_groundings_that_change_different_items_are_not_alike(code, where, do):
    assert not skills_alike(watering(code, where, do))


@pytest.mark.parametrize(("where", "do"), [("p.id == 1", "p.wet = state.rain;"), ("falls", "p.wet = true;")])
def test_a_variable_that_reaches_an_item_matters(where, do):
    assert irrelevant_variables(watering("bool falls = state.rain;", where, do)) == set()


def test_a_draw_shapes_the_state_through_what_earlier_assignments_point_to():
    found = "tPlant* dry = nullptr;\nfor (auto each : state__.tPlantObjects) dry = each;\n"
    project = watering(found + "dry->wet = AOS.Bernoulli(0.5);", "p.id == 1", "p.id = 2;")
    sensing = sensing_draws(project)
    assert not any(sensing.values())
    assert not certain_rewards(project, sensing)


def test_no_reward_is_certain_where_the_condition_of_a_special_state_draws():
    for condition, certain in (("state.rain", {"water"}), ("AOS.Bernoulli(0.5)", set())):
        project = watering("", "", "p.wet = true;", GARDEN.replace("state.plant.wet", condition))
        assert certain_rewards(project, {}) == certain
