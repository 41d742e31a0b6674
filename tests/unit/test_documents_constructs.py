import json
from typing import Any

from places import ROOT
from projects import files_project, text_project
from texts import encoded

from aos_protocol.documents import LocalSource, Project

FOLDER = ROOT / "docs" / "examples" / "kettle-json"
ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING = (
    json.loads((FOLDER / f"{name}.json").read_text())
    for name in ("environment", "environment glue", "pour", "pour glue")
)
ENVIRONMENT |= {
    "HeuristicStateValue": [{"AssignmentCode": "__heuristicValue = 1;"}],
    "PrintStateFunc": [{"AssignmentCode": "ss << state.water;"}],
}
ENVIRONMENT["GlobalVariableTypes"][1]["Variables"] += [
    {"Name": "at", "Type": "Water", "Default": "Warm;"},
    {"Name": "drunk", "Type": "bool", "Default": "", "ML_IgnoreVariable": True},
]
ENVIRONMENT["SpecialStates"][0]["StateConditionCode"] += " "
ENVIRONMENT["GlobalVariablesDeclaration"] += [{"Name": "raw", "Type": "vector<int>"}]
SKILL["GsdlMain"] = SKILL.pop("PlpMain") | {"Type": "GSDL"}
SKILL["DynamicModel"]["NextStateAssignments"] += [{"TempVar": {"VarName": "fails", "Type": "bool"}}]
MAPPING["GsdlMain"] = MAPPING.pop("PlpMain") | {"Type": "AM"}
MAPPING["ModuleResponse"]["ResponseRules"][0]["ConditionCodeWithLocalVariables"] += " "
MAPPING["ModuleActivation"]["RosService"]["ImportCode"] += [{"Import": ["math"]}]
MAPPING["LocalVariablesInitialization"][3]["IsHeavyVariable"] = True


def project_of(*documents: dict[str, Any]) -> Project:
    return text_project({f"{i} document.json": json.dumps(each) for i, each in enumerate(documents)})


def test_every_construct_of_a_json_environment_is_read():
    environment = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).environment
    assert (environment.horizon, environment.discount, environment.is_one_state_model) == (8, 0.95, False)
    assert environment.enums[0].values == ("Cold", "Warm", "Boiling")
    full, handle, at, drunk = environment.compounds[0].fields
    assert (full.default.code, at.default.code, drunk.default) == ("false", "Warm", None)
    assert (handle.type, handle.low_level_type, handle.default) == ("anyValue", "Pose", None)
    water, wanted, left, _, seen, poured, raw = environment.variables
    assert (water.default_value.code, wanted.is_mission_parameter) == ("Cold", True)
    assert left.is_parameter_value
    assert (seen.is_array, raw.type, poured.key_types) == (True, "vector<int>", ("Water", "(0,3,1)"))
    draw, _ = environment.initial_belief
    assert (draw.name, draw.temporary.enum_name, draw.temporary.enum_values) == (
        "warm already?", "Start", ("tap", "boiler"),
    )  # fmt: skip
    goal, once, code = environment.special_states
    assert (goal.condition.code, goal.reward, goal.is_goal) == ("state.mine.is_full", 10.0, True)
    assert (once.is_one_time, goal.is_one_time) == (True, False)
    assert (code.condition, len(code.code[0].code.origins)) == (None, 2)
    blocks = (environment.extrinsic_changes, environment.state_heuristic, environment.print_state)
    assert [len(block) for block in blocks] == [1, 1, 1]


def test_every_construct_of_a_json_skill_is_read_under_the_papers_names():
    (skill,) = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).skills
    model = skill.model
    assert [(p.name, p.type) for p in model.parameters] == [("cup", "Cup")]
    assert model.violation_penalty == -1.5
    (loop,) = model.precondition[0].over_previous
    assert (loop.type, loop.item) == ("Cup", "each")
    blocks = (model.rollout_policy, model.execution_time, model.state_given_observation)
    assert [len(block) for block in blocks] == [1, 1, 1]
    over_next, code, temporary = model.dynamic_model
    assert (temporary.temporary.type, len(over_next.over_next)) == ("bool", 1)
    assert len(code.code.origins) == 3


def test_every_construct_of_a_json_mapping_is_read():
    (skill,) = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).skills
    mapping = skill.mapping
    poured, spilt = mapping.rules
    assert poured.condition.code == "is_full and (success or __skill_status == 'stopped')"
    assert spilt.condition is None
    activation = mapping.activation
    assert (activation.kind, activation.path, activation.service_type) == ("ros_service", "/pour", "Pour")
    assert activation.max_duration_s == 60
    assert [(i.module, i.names) for i in activation.imports] == [("kettle.srv", ("Pour",)), ("", ("math",))]
    handle, success, _, is_full = mapping.local_variables
    assert [v.source for v in (handle, success, is_full)] == [
        LocalSource.PARAMETER,
        LocalSource.SERVICE_RESPONSE,
        LocalSource.TOPIC,
    ]
    assert (handle.parameter_path, is_full.topic, is_full.message_type) == ("cup.handle", "/scale", "Scale")
    assert (is_full.is_heavy, success.is_heavy) == (True, False)
    assert is_full.code.code == "if __input.grams > 150:\n    return True\nreturn False"


def test_low_level_types_and_constants_are_read():
    low_level = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).low_level
    assert low_level.types[0].fields[0].name == "x"
    (constant,) = low_level.constants
    assert (constant.name, constant.type) == ("___left_handle", "Pose")
    assert constant.code.code == "___left_handle.x = 0.3"


def test_a_text_response_and_parameters_by_code_are_read_from_both_dialects():
    skill = {
        "PlpMain": {"Project": "kettle", "Name": "look", "Type": "PLP"},
        "GlobalVariableModuleParameters": [{"Name": "cell", "Type": "int"}],
        "PossibleParametersValue": [
            {"AssignmentCode": "__possibleParameters.push_back(std::make_tuple(1));"}
        ],
        "DynamicModel": {"NextStateAssignments": [{"AssignmentCode": '__moduleResponseStr = "x";'}]},
    }
    mapping = {
        "PlpMain": {"Project": "kettle", "Name": "look", "Type": "Glue"},
        "ModuleResponse": {"FromStringLocalVariable": "text"},
        "ModuleActivation": {"Skill": {"ServicePath": "/look"}, "MaxDuration": 4},
        "LocalVariablesInitialization": [
            {"LocalVariableName": "text", "FromROSServiceResponse": True, "AssignmentCode": "text = 'x'"}
        ],
    }
    sdl = {
        "see.sd": "project: kettle\nparameter: int cell\navailable_parameters_code:\n"
        "__possibleParameters.push_back(std::make_tuple(1));\ndynamic_model:\n"
        '__moduleResponseStr = "x";',
        "see.am": "project: kettle\nlocal_variable: text\nfrom_ros_reservice_response: true\ncode:\n"
        "text = 'x'\nmodule_activation: skill\npath: /see\nmax_duration: 4\n\nresponse_local_variable: text",
    }
    environment = {k: v for k, v in ENVIRONMENT.items() if k != "ExtrinsicChangesDynamicModel"}
    documents = (environment, LOW_LEVEL, skill, mapping)
    files = {f"{i}.json": json.dumps(document).encode() for i, document in enumerate(documents)}
    look, see = files_project(files | encoded(sdl)).skills
    for read_skill in (look, see):
        assert read_skill.mapping.response_variable == "text"
        assert (read_skill.mapping.activation.kind, read_skill.mapping.activation.max_duration_s) == (
            "skill",
            4.0,
        )
        assert len(read_skill.model.possible_parameters) == 1


def test_null_counts_as_absent():
    mapping = MAPPING | {"ModuleResponse": None}
    skill = SKILL | {"DynamicModel": {"NextStateAssignments": []}, "Preconditions": None}
    (read,) = project_of(ENVIRONMENT, LOW_LEVEL, skill, mapping).skills
    assert (read.mapping.rules, read.model.precondition) == ((), ())
