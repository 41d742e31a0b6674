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
    """The mapping with every construct, to be changed."""
    return copy.deepcopy(MAPPING)


def load(*documents: dict[str, Any]) -> LoadedBundle:
    return load_files({f"{i}.json": json.dumps(document).encode() for i, document in enumerate(documents)})


def emitted(*mappings: dict[str, Any]) -> tuple[EmittedMapping, ...]:
    """The modules of skills that are alike but for their names and mappings."""
    skills = [copy.deepcopy(SKILL) for _ in mappings]
    for skill, mapping in zip(skills, mappings, strict=True):
        skill["GsdlMain"]["Name"] = mapping["GsdlMain"]["Name"]
    bundle = load(ENVIRONMENT, LOW_LEVEL, *skills, *mappings)
    assert bundle.project is not None, bundle.diagnostics
    return emit_project(bundle.project)


TO_HOME = {"to": {"pose": "___home"}}


def test_an_empty_condition_always_holds(mapping: dict[str, Any]):
    (go,) = emitted(mapping)
    assert observed(loaded(go), TO_HOME, [], {"success": False}).response == "eFailed"


@pytest.mark.parametrize("name", ["e Done", "e*"])
def test_a_response_is_a_word(mapping: dict[str, Any], name):
    mapping["ModuleResponse"]["ResponseRules"][0]["Response"] = name
    found = load(ENVIRONMENT, LOW_LEVEL, SKILL, mapping).diagnostics
    assert "AOS126" in [finding.code for finding in found if finding.is_error]


@pytest.mark.parametrize("type_name", [None, "Bool", "bool", "int[]"])
def test_the_type_of_a_variable_changes_nothing_of_its_value(mapping: dict[str, Any], type_name):
    done = mapping["LocalVariablesInitialization"][1]
    del done["VariableType"]
    if type_name is not None:
        done["VariableType"] = type_name
    (go,) = emitted(mapping)
    assert observed(loaded(go), TO_HOME, [], {"success": True}).local_variables["done"] == "true"


def test_code_may_be_a_list_of_lines_with_tabs(mapping: dict[str, Any]):
    noisy = mapping["LocalVariablesInitialization"][2]
    noisy["AssignmentCode"] = ["if __input.level > 3:", "\treturn True", "return False"]
    (go,) = emitted(mapping)
    result = observed(loaded(go), TO_HOME, [("/noise", {"level": 5})], {"success": True})
    assert (result.response, result.local_variables["noisy"]) == ("eFailed", "true")


def test_variables_of_one_name_in_two_mappings_have_nothing_to_do_with_each_other(mapping: dict[str, Any]):
    other = copy.deepcopy(mapping)
    other["GsdlMain"]["Name"] = "come"
    other["LocalVariablesInitialization"][1] |= {
        "VariableType": "string",
        "AssignmentCode": "done = 'done is ' + str(__input.success)",
    }
    texts = {}
    for generated in emitted(mapping, other):
        texts[generated.skill] = observed(loaded(generated), TO_HOME, [], {"success": True}).local_variables[
            "done"
        ]
    assert texts == {"go": "true", "come": '"done is True"'}


def test_imports_are_those_of_the_mapping_alone(mapping: dict[str, Any]):
    other = copy.deepcopy(mapping)
    other["GsdlMain"]["Name"] = "come"
    other["ModuleActivation"]["RosService"]["ImportCode"] = [{"Import": ["cmath"]}]
    modules = {generated.skill: generated.python for generated in emitted(mapping, other)}
    assert "import math" in modules["go"]
    assert "import math" not in modules["come"]


def test_fields_are_computed_from_all_local_variables(mapping: dict[str, Any]):
    service = mapping["ModuleActivation"]["RosService"]
    service["ServiceParameters"] = [{"ServiceFieldName": "loud", "AssignServiceFieldCode": "not noisy"}]
    (go,) = emitted(mapping)
    assert fields(loaded(go), TO_HOME) == {"loud": True}
