import math

import pytest
from mappings import mapping_text
from projects import text_project
from scripted_models import json_text, lowered

from aos_language.cpp.snippets import read_cpp
from aos_language.observed import misuses_of, reported_numbers, reports_in
from aos_middleware.activations.activation import numbers_among, observed_numbers
from aos_middleware.emission.emit import emit_mapping
from aos_solver.child.lines.command_line import numbers_by_name, numbers_field
from aos_solver.emission.lowering.relevance import irrelevant_variables
from aos_solver.emission.program import Observed

DYNAMIC = """if (state.wet) __observed.depth = AOS.SampleNormal(2, 0.5);
else __observed.depth = AOSUtils::SampleUniform(0, 1);
for (int i = 0; i < 3; i++) { __observed.echoes[i] = AOS.SampleDiscrete(tRoom, {0.5, 0.5}); }
__observed.echoes.push_back( AOSUtils::SampleDiscrete(vector<double>{1.0}) );
switch (1) { case 1: __observed.loud = AOS.Bernoulli(0.2); }
"""
ENVIRONMENT = {
    "GlobalVariableTypes": [{"TypeName": "tRoom", "Type": "enum", "EnumValues": ["eHall", "eLab"]}],
    "GlobalVariablesDeclaration": [{"Name": "wet", "Type": "bool", "Default": "false"}],
    "EnvironmentGeneral": {"Horizon": 5, "Discount": 0.9},
}
LOCALS = "".join(
    f"local_variable: {name}\ntype: {kind}\nfrom_ros_service_response: true\n"
    f"code:\n{name} = __input.{name}\n\n"
    for name, kind in (("depth", "double"), ("echoes", "int[]"), ("loud", "bool"))
)


def test_reports_are_found_wherever_a_statement_may_stand():
    cpp = read_cpp(DYNAMIC)
    assert misuses_of(cpp) == ()
    assert [(report.name, report.is_array, report.draw.name[1]) for report in reports_in(cpp)] == [
        ("depth", False, "SampleNormal"),
        ("depth", False, "SampleUniform"),
        ("echoes", True, "SampleDiscrete"),
        ("echoes", True, "SampleDiscrete"),
        ("loud", False, "Bernoulli"),
    ]


@pytest.mark.parametrize(
    ("code", "column"),
    [
        ("double x = __observed.depth;", 12),
        ("f(__observed.depth);", 3),
        ("double& x = __observed.depth;", 13),
        ("__observed.depth++;", 1),
        ("__observed.echoes.clear();", 1),
        ("__observed->depth = AOS.Bernoulli(0.5);", 1),
        ("__observed.depth = 3;", 20),
        ("__observed.depth = max(0.0, AOS.SampleNormal(0, 1));", 20),
        ("__observed.depth = other.SampleNormal(0, 1);", 20),
        ("if (__observed.loud = AOS.Bernoulli(0.5)) return;", 5),
        ("__observed.echoes.push_back(2 * AOS.SampleUniform(0, 1));", 29),
    ],
)
def test_whatever_else_is_done_with_them_is_a_misuse(code, column):
    (misuse,) = misuses_of(read_cpp(code))
    assert misuse.extent.start + 1 == column
    assert reports_in(read_cpp(code)) == ()


@pytest.mark.parametrize("dialect", ["sdl", "json"])
def test_a_reported_draw_is_emitted_as_its_distribution(dialect):
    skill = {"DynamicModel": {"NextStateAssignments": [{"AssignmentCode": DYNAMIC.split("\n")}]}}
    model = (
        {"look.sd": f"project: test\n\ndynamic_model:\n{DYNAMIC}"}
        if dialect == "sdl"
        else {"look.json": json_text(skill, "PLP", "look")}
    )
    mapping = {"look.am": f"{mapping_text()}\n{LOCALS}"}
    project = text_project(
        {"test.json": json_text(ENVIRONMENT, "Environment", "environment"), **model, **mapping}
    )
    assert [number.name for number in reported_numbers(project.skills[0].model)] == [
        "depth", "echoes", "loud",
    ]  # fmt: skip
    emitted, _ = lowered(project)
    for line in (
        "if (state.wet) __observed.depth = aos::Normal(2, 0.5);",
        "else __observed.depth = aos::Uniform(0, 1);",
        "aos::at(__observed.echoes, i) = aos::Discrete(aos::normalised, {0.5, 0.5});",
        "__observed.echoes.push_back( aos::Discrete({1.0}) );",
        "case 1: __observed.loud = aos::Bernoulli(0.2);",
    ):
        assert line in emitted.cpp
    assert emitted.observed == {
        "look": (Observed("depth", False), Observed("echoes", True), Observed("loud", False))
    }
    assert emit_mapping(project.skills[0]).observed == ("depth", "echoes", "loud")


def test_a_variable_matters_that_only_a_number_depends_on():
    environment = dict(ENVIRONMENT)
    environment["GlobalVariablesDeclaration"] = [
        {"Name": name, "Type": "int", "Default": "0"} for name in ("depth_cm", "walls", "pushed", "spare")
    ]
    dynamic = """state__.spare = state.depth_cm;
    double middle = state.depth_cm / 100.0;
    __observed.depth = AOS.SampleNormal(middle, 0.5);
    for (int i = 0; i < state.walls; i++) __observed.echoes[i] = AOS.Bernoulli(0.5);
    if (state.pushed > 0) __observed.echoes.push_back(AOS.Bernoulli(0.5));
    __observed.loud = AOS.Bernoulli(0.5);
    state__.depth_cm += 1; state__.walls += 1; state__.pushed += 1;
    """
    project = text_project(
        {
            "test.json": json_text(environment, "Environment", "environment"),
            "look.sd": f"project: test\n\ndynamic_model:\n{dynamic}",
            "look.am": f"{mapping_text()}\n{LOCALS}",
        }
    )
    assert irrelevant_variables(project) == {"spare"}


def test_numbers_are_taken_from_local_variables_that_hold_some():
    texts = {
        "depth": "1.5", "level": "3", "loud": "true", "echoes": "[1.0, null, 2]", "none": "null",
        "words": '"deep"', "odd": "<object object at 0x1>", "mixed": '[1, "a"]', "nested": "[[1]]",
        "huge": "9" * 400,
    }  # fmt: skip
    assert observed_numbers([*texts, "unknown"], texts) == {
        "depth": 1.5, "level": 3, "loud": True, "echoes": [1.0, None, 2],
    }  # fmt: skip
    assert numbers_among({"depth": "deep", "level": 3, "echoes": ["a"], "nan": math.nan}) == {"level": 3}


def test_numbers_go_to_an_engine_and_come_back_by_name():
    observed = (Observed("depth", False), Observed("echoes", True), Observed("loud", False))
    numbers = {"depth": 0.1, "echoes": [1, None, 2.5], "loud": None}
    assert numbers_field(observed, numbers) == "0 0 0.1 1 0 1.0 1 2 2.5"
    assert numbers_by_name(observed, [(0, 0, 0.1), (1, 0, 1.0), (1, 2, 2.5)]) == {
        "depth": 0.1,
        "echoes": [1.0, None, 2.5],
    }
