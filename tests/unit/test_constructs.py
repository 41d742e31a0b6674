"""Each construct of the languages used wrongly: refused, or warned of, where the mistake is.

tests/constructs.md lists the constructs, with the tests that show each of them at work.
"""

import re

import pytest
from places import ROOT
from test_reading_rules import Rule, bundle_of

from aos_language.load import load_files
from aos_solver.emission.lowering.lower import lower

MISUSES = {
    "v1.x JSON": Rule("go.json", '"§«PlpMain→PlpMian»"', "AOS102"),
    "paper GSDL JSON": Rule(
        "go.json",
        '"«PlpMain→GsdlMain»": {"Project": "two rooms", "Name": "go", "Type": "§«PLP→GDSL»"',
        "AOS106",
    ),
    "SDL 2.0": Rule("room.ef", "§«horizon→horizont»: 5", "AOS102"),
    "enum": Rule(
        "room.json", '{"TypeName": "§tRoom", "Type": "enum", "EnumValues": [«"eHall", "eLab"→»]}', "AOS105"
    ),
    "compound type": Rule("room.json", '"Name": "room", "Type": "§«tRoom→tRom»"', "AOS110"),
    "mission parameter": Rule(
        "room.ef",
        "horizon: 5«→\nmission_parameter: int count\nextrinsic_code:\n§state_.count = 2;»",
        "AOS128",
    ),
    "array": Rule("room.ef", "int steps §[«→2»]", "AOS104"),
    "array over an enum": Rule("room.ef", "int steps [§«→tRom»]", "AOS110"),
    "vector<...>": Rule("room.ef", "§«int steps []→vector<Roof> steps»", "AOS110"),
    "map variable": Rule("room.json", '"«IsArray": true→Parameters": ["§(0,3)"]»,', "AOS106"),
    "anyValue": Rule(
        "room.json",
        '{"Name": "§pose", "Type": "anyValue", "UnderlineLocalVariableType": "«Pose→Pos»"}',
        "AOS110",
    ),
    "EnvironmentGlue constant": Rule(
        "low.json", '"Constants": [«→{"Name": "___p", "Type": "Pose", "InitCode": "___p.x = §(1"}»]', "AOS121"
    ),
    "temporary variable": Rule(
        "go.json", '{"«IterateNextStateVars": []→TempVar": {"VarName": "§n", "Type": "it"}»}', "AOS110"
    ),
    "temporary enum": Rule(
        "go.json",
        '§{"VarName": "end", "Type": "enum", "EnumName": "tEnd", "EnumValues": [«"eWell", "eBadly"→»]}',
        "AOS105",
    ),
    "IteratePreviousStateVars": Rule(
        "go.json",
        '{"«IterateNextStateVars": [→IteratePreviousStateVars": [{"Type": "§tDor", "ItemName": "d"}»]}',
        "AOS110",
    ),
    "IterateNextStateVars": Rule(
        "room.json",
        '"«AssignmentName": "start"→IterateNextStateVars": [{"Type": "§tDoor", "ItemName": "d"}]»,',
        "AOS123",
    ),
    "xObjects": Rule("go.json", "if («end == eWell→state.§tDorObjects.empty()»)", "AOS110"),
    "xObjectsForActions": Rule(
        "go.json", "if («end == eWell→state.§tDorObjectsForActions.empty()»)", "AOS110"
    ),
    "declared action values": Rule("go.sd", "parameter: «Door→float» §door", "AOS119"),
    "__possibleParameters": Rule(
        "go.sd", "«→available_parameters_code:\n§__posibleParameters.push_back({});\n»precondition:", "AOS110"
    ),
    "precondition": Rule("go.json", "!§«state→state__».closed", "AOS123"),
    "penalty": Rule("go.json", '§«-2→"-2"»\n', "AOS106"),
    "rollout policy": Rule("go.sd", "«→rollout_policy:\n§state.at = Hall;\n»violate_penalty", "AOS123"),
    "state heuristic": Rule("room.ef", "«→heuristic_code:\n§state.at = Lab;\n»initial_belief:", "AOS123"),
    "module execution time": Rule(
        "go.json",
        '"«→ModuleExecutionTimeDynamicModel": [{"AssignmentCode": "§state.at = eLab;"}], "»DynamicModel"',
        "AOS123",
    ),
    "special state, condition": Rule("room.json", "§«state→state_».at == eLab", "AOS123"),
    "special state, code": Rule("room.ef", "if (§«state→state__».at == Lab)", "AOS123"),
    "one-time reward": Rule("room.json", '"IsGoalState": true«→, "IsOneTimeReward": §3»', "AOS106"),
    "goal": Rule("room.ef", "§«__isGoalState→__isGoal»", "AOS110"),
    "failure": Rule("room.ef", "§«__isGoalState→__isFailState»", "AOS110"),
    "extrinsic changes": Rule(
        "room.json",
        '"ExtrinsicChangesDynamicModel": [«→{"AssignmentCode": "§state__.at = eLab;"}»]',
        "AOS123",
    ),
    "chosen action": Rule(
        "room.json",
        '"ExtrinsicChangesDynamicModel": [«→{"AssignmentCode": "if (go->§oDor.room) return;"}»]',
        "AOS110",
    ),
    "string observation": Rule(
        "go glue.json", '{"«→FromStringLocalVariable": "§txt", "»ResponseRules"', "AOS110"
    ),
    "__observed": Rule("go.sd", "«__reward = -1→__observed.steps = §1 + AOS.SampleNormal(0, 1)»;", "AOS138"),
    "state given observation": Rule(
        "go.json",
        '"«→StateGivenObservationModel": '
        '{"Assignments": [{"AssignmentCode": "§state__.at = eLab;"}]}, "»DynamicModel"',
        "AOS123",
    ),
    "OneStateModel": Rule("room.ef", "horizon: 5«→\none_state_model: §perhaps»", "AOS106"),
    "print function": Rule(
        "room.json",
        '"ExtrinsicChangesDynamicModel": []«→, "PrintStateFunc": [{"AssignmentCode": "§state.at = eLab;"}]»',
        "AOS123",
    ),
    "AOS.Bernoulli": Rule("room.json", "AOS.Bernoulli(§«0.5→1.5»)", "AOS122"),
    "AOS.SampleDiscrete": Rule("go.json", "§{0.9, «→-»0.1}", "AOS122"),
    "AOS.SampleNormal": Rule("room.json", "AOS.«Bernoulli(0.5)→SampleNormal(0, §-1) > 0»", "AOS122"),
    "AOS.SampleUniform": Rule("room.json", "AOS.«Bernoulli(0.5)→SampleUniform(2, §1) > 1.5»", "AOS122"),
    "AOSUtils": Rule("room.ef", "«AOS.Bernoulli→AOSUtils::§Bernouli»(0.5)", "AOS110"),
    "AOS.SetNull and its like": Rule(
        "go.json", "«→AOS.§SetNul(state__.door.pose); »if (end == eWell)", "AOS110"
    ),
    "response rules": Rule("go.json", "? eDone : §«eLost→eGone»", "AOS116"),
    "shared code": Rule("room.ef", "horizon: 5«→\nshared_code:\nint §count = 3;»", "AOS145"),
    "shared code of mappings": Rule(
        "room.ef", "horizon: 5«→\nshared_mapping_code:\ndef far(x) §return x»", "AOS121"
    ),
    "stop_when": Rule("go glue.json", '"«GlueFramework": "ROS→StopWhen": "§ok»",', "AOS110"),
    "monitor": Rule("go glue.json", '"«→Monitor": "§battery", "»GlueFramework": "ROS",', "AOS114"),
    "no mapping": Rule("go glue.json", '"Name": "§«go→goo»"', "AOS114"),
    "local variables": Rule("go glue.json", '"§oDoor.«pose→where»"', "AOS110"),
}

WARNED_OF = {"AOS.SampleUniform", "anyValue"}
"""All other misuses are errors."""


def page_rows() -> dict[str, tuple[str, str]]:
    page = (ROOT / "tests" / "constructs.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([^|]+) \| `([^`|]+)` \| (AOS\d{3}) \|$", page, re.MULTILINE)
    return {name.replace("`", ""): (test, code) for name, test, code in rows}


@pytest.mark.parametrize("construct", MISUSES)
def test_a_construct_that_is_misused_is_told_at_its_place(construct):
    rule = MISUSES[construct]
    files, place = bundle_of(rule)
    loaded = load_files(files)
    findings = list(loaded.diagnostics)
    if loaded.project is not None:
        findings += lower(loaded.project)[1]
    texts = [f"{finding.span} {finding.code} {finding.message}" for finding in findings]
    told = [finding for finding in findings if (finding.code, finding.span) == (rule.code, place)]
    assert told, texts
    assert any(finding.is_error for finding in told) == (construct not in WARNED_OF)


def test_the_page_of_the_constructs_names_every_one_and_tests_that_exist():
    rows = page_rows()
    assert {name: code for name, (_, code) in rows.items()} == {
        name: rule.code for name, rule in MISUSES.items()
    }
    for test, _ in rows.values():
        file, _, function = test.rpartition("/")[2].partition("::")
        folder = test.rpartition("/")[0] or "unit"
        source = (ROOT / "tests" / folder / f"{file}.py").read_text(encoding="utf-8")
        assert f"def {function}(" in source, test
