"""Every construct of the JSON and SDL dialects in the typed model."""

import json
from typing import Any

from texts import encoded

from aos_language.load import load_files
from aos_protocol.documents import LocalSource, Project

ENVIRONMENT: dict[str, Any] = {
    "PlpMain": {"Project": "p", "Name": "environment", "Type": "Environment", "Version": 1},
    "EnvironmentGeneral": {"Horizon": 10.0, "Discount": 1, "OneStateModel": False},
    "GlobalVariableTypes": [
        {"TypeName": "Place", "Type": "enum", "EnumValues": ["Here", "There"]},
        {
            "TypeName": "Spot",
            "Type": "compound",
            "Variables": [
                {"Name": "place", "Type": "Place", "Default": "There;"},
                {"Name": "pose", "Type": "anyValue", "UnderlineLocalVariableType": "Pose"},
                {"Name": "seen", "Type": "bool", "Default": "", "ML_IgnoreVariable": True},
            ],
        },
    ],
    "GlobalVariablesDeclaration": [
        {"Name": "at", "Type": "Place", "Default": "Here"},
        {"Name": "grid", "Type": "int", "IsArray": True, "DefaultCode": "state.grid={1,2,3}"},
        {"Name": "raw", "Type": "vector<int>"},
        {"Name": "visits", "Type": "int", "Parameters": ["Place", "(0,3,1)"], "DefaultCode": "x"},
        {
            "Name": "home",
            "Type": "Spot",
            "DefaultCode": "state.home.place = Here; state.home.pose = ___home;",
            "IsActionParameterValue": True,
        },
    ],
    "InitialBeliefStateAssignments": [
        {
            "AssignmentName": "draw",
            "TempVar": {
                "VarName": "case_",
                "Type": "enum",
                "EnumName": "Case",
                "EnumValues": ["first", "second"],
            },
            "AssignmentCode": ["case_ = AOS.SampleDiscrete(Case,{0.5,0.5});", "state.at = Here;"],
        }
    ],
    "SpecialStates": [
        {"StateConditionCode": "state.at == There ", "Reward": 5, "IsOneTimeReward": True},
        {"StateFunctionCode": [{"AssignmentCode": "__isGoalState = state.at == There;"}]},
    ],
    "ExtrinsicChangesDynamicModel": [{"AssignmentCode": "if (go != NULL && go->to.seen) state_.at = Here;"}],
    "HeuristicStateValue": [{"AssignmentCode": "__heuristicValue = 1;"}],
    "PrintStateFunc": [{"AssignmentCode": "ss << state.at;"}],
}
LOW_LEVEL: dict[str, Any] = {
    "PlpMain": {"Project": "p", "Name": "environment", "Type": "EnvironmentGlue"},
    "LocalVariableTypes": [{"TypeName": "Pose", "Variables": [{"Name": "x", "Type": "float"}]}],
    "Constants": [{"Name": "___home", "Type": "Pose", "InitCode": "___home.x=1\n___home.x+=1"}],
}
SKILL: dict[str, Any] = {
    "GsdlMain": {"Project": "p", "Name": "go", "Type": "GSDL"},
    "GlobalVariableModuleParameters": [{"Name": "to", "Type": "Spot"}],
    "Preconditions": {
        "GlobalVariablePreconditionAssignments": [
            {
                "IteratePreviousStateVars": [
                    {
                        "Type": "Spot",
                        "ItemName": "spot",
                        "ConditionCode": "spot.place == to.place",
                        "WhenConditionTrueCode": "__meetPrecondition = !spot.seen;",
                    }
                ]
            }
        ],
        "PlannerAssistancePreconditionsAssignments": [{"AssignmentCode": "__heuristicValue = 2;"}],
        "ViolatingPreconditionPenalty": -1.5,
    },
    "ModuleExecutionTimeDynamicModel": [{"AssignmentCode": "__moduleExecutionTime = 3;"}],
    "DynamicModel": {
        "NextStateAssignments": [
            {"TempVar": {"VarName": "fails", "Type": "bool"}},
            {
                "IterateNextStateVars": [
                    {
                        "Type": "Spot",
                        "ItemName": "spot",
                        "ConditionCode": "!spot.seen",
                        "WhenConditionTrueCode": "spot.seen = true;",
                    }
                ]
            },
            {"AssignmentCode": "fails = AOS.Bernoulli(0.5); __moduleResponse = fails ? eFailed : eDone;"},
        ]
    },
    "StateGivenObservationModel": {"Assignments": [{"AssignmentCode": "state___.at = There;"}]},
}
MAPPING: dict[str, Any] = {
    "GsdlMain": {"Project": "p", "Name": "go", "Type": "AM"},
    "ModuleResponse": {
        "ResponseRules": [
            {"Response": "eDone", "ConditionCodeWithLocalVariables": " done and not noisy "},
            {"Response": "eFailed", "ConditionCodeWithLocalVariables": ""},
        ]
    },
    "ModuleActivation": {
        "RosService": {
            "ServicePath": "/go",
            "ServiceName": "Go",
            "ServiceParameters": [{"ServiceFieldName": "pose", "AssignServiceFieldCode": "pose"}],
            "ImportCode": [{"From": "nav.srv", "Import": ["Go", "GoResponse"]}, {"Import": ["math"]}],
        }
    },
    "LocalVariablesInitialization": [
        {"InputLocalVariable": "pose", "FromGlobalVariable": "to.pose"},
        {
            "LocalVariableName": "done",
            "VariableType": "bool",
            "FromROSServiceResponse": True,
            "AssignmentCode": "done = __input.success",
        },
        {
            "LocalVariableName": "noisy",
            "RosTopicPath": "/noise",
            "TopicMessageType": "Noise",
            "InitialValue": "False",
            "IsHeavyVariable": True,
            "AssignmentCode": ["if __input.level > 3:", "    return True", "return False"],
        },
    ],
}


def project_of(*documents: dict[str, Any]) -> Project:
    files = {f"{i} document.json": json.dumps(document).encode() for i, document in enumerate(documents)}
    loaded = load_files(files)
    assert loaded.project is not None, loaded.diagnostics
    return loaded.project


def test_every_construct_of_a_json_environment_is_read():
    project = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING)
    environment = project.environment
    assert (environment.horizon, environment.discount, environment.is_one_state_model) == (10, 1.0, False)
    assert environment.enums[0].values == ("Here", "There")
    place, pose, sight = environment.compounds[0].fields
    assert place.default.code == "There"
    assert (pose.type, pose.low_level_type, sight.default) == ("anyValue", "Pose", None)
    at, grid, raw, visits, home = environment.variables
    assert at.default_value is not None
    assert (grid.is_array, raw.type, visits.key_types) == (True, "vector<int>", ("Place", "(0,3,1)"))
    assert home.is_parameter_value
    (draw,) = environment.initial_belief
    assert (draw.temporary.enum_name, draw.temporary.enum_values) == ("Case", ("first", "second"))
    assert len(draw.code.origins) == 2
    first, second = environment.special_states
    assert (first.condition.code, first.reward, first.is_one_time) == ("state.at == There", 5.0, True)
    assert (second.condition, len(second.code)) == (None, 1)
    blocks = (environment.extrinsic_changes, environment.state_heuristic, environment.print_state)
    assert [len(block) for block in blocks] == [1, 1, 1]


def test_every_construct_of_a_json_skill_is_read_under_the_papers_names():
    (skill,) = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).skills
    model = skill.model
    assert [(p.name, p.type) for p in model.parameters] == [("to", "Spot")]
    assert model.violation_penalty == -1.5
    (loop,) = model.precondition[0].over_previous
    assert (loop.type, loop.item) == ("Spot", "spot")
    blocks = (model.rollout_policy, model.execution_time, model.state_given_observation)
    assert [len(block) for block in blocks] == [1, 1, 1]
    temporary, over_next, code = model.dynamic_model
    assert (temporary.temporary.type, len(over_next.over_next)) == ("bool", 1)
    assert code.code is not None


def test_every_construct_of_a_json_mapping_is_read():
    (skill,) = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).skills
    mapping = skill.mapping
    done, failed = mapping.rules
    assert (done.condition.code, failed.condition) == ("done and not noisy", None)
    activation = mapping.activation
    assert (activation.kind, activation.path, activation.service_type) == ("ros_service", "/go", "Go")
    assert [(i.module, i.names) for i in activation.imports] == [
        ("nav.srv", ("Go", "GoResponse")),
        ("", ("math",)),
    ]
    pose, result, noisy = mapping.local_variables
    assert [v.source for v in (pose, result, noisy)] == [
        LocalSource.PARAMETER,
        LocalSource.SERVICE_RESPONSE,
        LocalSource.TOPIC,
    ]
    assert (pose.parameter_path, noisy.topic, noisy.message_type, noisy.is_heavy) == (
        "to.pose",
        "/noise",
        "Noise",
        True,
    )
    assert noisy.code.code == "if __input.level > 3:\n    return True\nreturn False"


def test_low_level_types_and_constants_are_read():
    low_level = project_of(ENVIRONMENT, LOW_LEVEL, SKILL, MAPPING).low_level
    assert low_level.types[0].fields[0].name == "x"
    (constant,) = low_level.constants
    assert (constant.name, constant.type, len(constant.code.origins)) == ("___home", "Pose", 2)


def test_a_text_response_and_parameters_by_code_are_read_from_both_dialects():
    skill = {
        "PlpMain": {"Project": "p", "Name": "look", "Type": "PLP"},
        "GlobalVariableModuleParameters": [{"Name": "cell", "Type": "int"}],
        "PossibleParametersValue": [
            {"AssignmentCode": "__possibleParameters.push_back(std::make_tuple(1));"}
        ],
        "DynamicModel": {"NextStateAssignments": [{"AssignmentCode": '__moduleResponseStr = "x";'}]},
    }
    mapping = {
        "PlpMain": {"Project": "p", "Name": "look", "Type": "Glue"},
        "ModuleResponse": {"FromStringLocalVariable": "text"},
        "ModuleActivation": {"Skill": {"ServicePath": "/look"}, "MaxDuration": 4},
        "LocalVariablesInitialization": [
            {"LocalVariableName": "text", "FromROSServiceResponse": True, "AssignmentCode": "text = 'x'"}
        ],
    }
    sdl = {
        "see.sd": "project: p\nparameter: int cell\navailable_parameters_code:\n"
        "__possibleParameters.push_back(std::make_tuple(1));\ndynamic_model:\n"
        '__moduleResponseStr = "x";',
        "see.am": "project: p\nlocal_variable: text\nfrom_ros_reservice_response: true\ncode:\ntext = 'x'\n"
        "module_activation: skill\npath: /see\nmax_duration: 4\n\nresponse_local_variable: text",
    }
    environment = {k: v for k, v in ENVIRONMENT.items() if k != "ExtrinsicChangesDynamicModel"}
    documents = (environment, LOW_LEVEL, skill, mapping)
    files = {f"{i}.json": json.dumps(document).encode() for i, document in enumerate(documents)}
    loaded = load_files(files | encoded(sdl))
    assert loaded.project is not None, loaded.diagnostics
    look, see = loaded.project.skills
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
