"""Original mappings, construct by construct: as docs/coming-from-aos-1.md tells them."""

import copy
import json
from typing import Any

import pytest
from mapping_runs import fields, loaded, observed
from test_documents_constructs import ENVIRONMENT, LOW_LEVEL, MAPPING, SKILL

from aos_language.load import LoadedBundle, load_files
from aos_middleware.emission.emit import EmittedMapping
from aos_middleware.mappings.revisions import emit_project


@pytest.fixture
def mapping() -> dict[str, Any]:
    return copy.deepcopy(MAPPING)


def load(*documents: dict[str, Any]) -> LoadedBundle:
    return load_files({f"{i}.json": json.dumps(document).encode() for i, document in enumerate(documents)})


def emitted(*mappings: dict[str, Any]) -> tuple[EmittedMapping, ...]:
    skills = [copy.deepcopy(SKILL) for _ in mappings]
    for skill, mapping in zip(skills, mappings, strict=True):
        skill["GsdlMain"]["Name"] = mapping["GsdlMain"]["Name"]
    bundle = load(ENVIRONMENT, LOW_LEVEL, *skills, *mappings)
    assert bundle.project is not None, bundle.diagnostics
    return emit_project(bundle.project)


CUP = {"cup": {"handle": "___left_handle"}}
GRIPPED = {"success": True, "grip": 1}


def test_an_empty_condition_always_holds(mapping: dict[str, Any]):
    (pour,) = emitted(mapping)
    assert observed(loaded(pour), CUP, [], {**GRIPPED, "success": False}).response == "spilt"


@pytest.mark.parametrize("name", ["e Done", "e*"])
def test_a_response_is_a_word(mapping: dict[str, Any], name):
    mapping["ModuleResponse"]["ResponseRules"][0]["Response"] = name
    found = load(ENVIRONMENT, LOW_LEVEL, SKILL, mapping).diagnostics
    assert "AOS126" in [finding.code for finding in found if finding.is_error]


@pytest.mark.parametrize("type_name", [None, "Bool", "bool", "int[]"])
def test_the_type_of_a_variable_changes_nothing_of_its_value(mapping: dict[str, Any], type_name):
    success = mapping["LocalVariablesInitialization"][1]
    del success["VariableType"]
    if type_name is not None:
        success["VariableType"] = type_name
    (pour,) = emitted(mapping)
    assert observed(loaded(pour), CUP, [], GRIPPED).local_variables["success"] == "true"


def test_code_may_be_a_list_of_lines_with_tabs(mapping: dict[str, Any]):
    is_full = mapping["LocalVariablesInitialization"][3]
    is_full["AssignmentCode"] = ["if __input.level > 3:", "\treturn True", "return False"]
    (pour,) = emitted(mapping)
    result = observed(loaded(pour), CUP, [("/scale", {"level": 5})], GRIPPED)
    assert (result.response, result.local_variables["is_full"]) == ("poured", "true")


def test_variables_of_one_name_in_two_mappings_have_nothing_to_do_with_each_other(mapping: dict[str, Any]):
    other = copy.deepcopy(mapping)
    other["GsdlMain"]["Name"] = "fill"
    other["LocalVariablesInitialization"][1] |= {
        "VariableType": "string",
        "AssignmentCode": "success = 'it is ' + str(__input.success)",
    }
    texts = {
        generated.skill: observed(loaded(generated), CUP, [], GRIPPED).local_variables["success"]
        for generated in emitted(mapping, other)
    }
    assert texts == {"pour": "true", "fill": '"it is True"'}


def test_imports_are_those_of_the_mapping_alone(mapping: dict[str, Any]):
    other = copy.deepcopy(mapping)
    other["GsdlMain"]["Name"] = "fill"
    other["ModuleActivation"]["RosService"]["ImportCode"] = [{"Import": ["cmath"]}]
    modules = {generated.skill: generated.python for generated in emitted(mapping, other)}
    assert "import math" in modules["pour"]
    assert "import math" not in modules["fill"]


def test_fields_are_computed_from_all_local_variables(mapping: dict[str, Any]):
    service = mapping["ModuleActivation"]["RosService"]
    service["ServiceParameters"] = [{"ServiceFieldName": "loud", "AssignServiceFieldCode": "not is_full"}]
    (pour,) = emitted(mapping)
    assert fields(loaded(pour), CUP) == {"loud": True}


def test_a_mapping_finds_what_only_another_one_imports(mapping: dict[str, Any]):
    other = copy.deepcopy(mapping)
    other["GsdlMain"]["Name"] = "fill"
    del other["ModuleActivation"]["RosService"]["ImportCode"]
    other["LocalVariablesInitialization"][1]["AssignmentCode"] = "success = math.floor(1.5) == 1"
    _, fill = emitted(mapping, other)
    assert observed(loaded(fill), CUP, [], GRIPPED).local_variables["success"] == "true"
    skill = copy.deepcopy(SKILL)
    skill["GsdlMain"]["Name"] = "fill"
    found = load(ENVIRONMENT, LOW_LEVEL, SKILL, skill, mapping, other).diagnostics
    told = [finding.message for finding in found if finding.span.file == "5.json"]
    assert told == ["`math` is imported in 4.json alone, and is taken from there"]
