"""A document as AOS 1.x JSON."""

import json
from collections.abc import Iterable
from typing import Any

from aos_protocol import documents

_TYPES = {
    documents.Environment: "Environment",
    documents.SkillModel: "PLP",
    documents.AbstractionMapping: "Glue",
}


def json_text(content: documents.Content, version: str = "") -> str:
    """The text of the document's JSON file."""
    header = {
        "Project": content.project,
        "Name": content.name
        if isinstance(content, (documents.SkillModel, documents.AbstractionMapping))
        else "environment",
        "Type": _TYPES.get(type(content), "EnvironmentGlue"),
        **_given(Version=version),
    }
    match content:
        case documents.Environment():
            body = _environment(content)
        case documents.SkillModel():
            body = _skill(content)
        case documents.AbstractionMapping():
            body = _mapping(content)
        case documents.LowLevelDocument():
            body = _low_level(content)
    return json.dumps({"PlpMain": header, **body}, indent=4, ensure_ascii=False) + "\n"


def _given(**members: object) -> dict[str, Any]:
    """Returns the members without those that are false, empty or None."""
    return {key: value for key, value in members.items() if value}


# --- environment and low-level document ---


def _environment(environment: documents.Environment) -> dict[str, Any]:
    enums = [
        {"TypeName": enum.name, "Type": "enum", "EnumValues": list(enum.values)} for enum in environment.enums
    ]
    return {
        "EnvironmentGeneral": {
            "Horizon": environment.horizon,
            "Discount": environment.discount,
            **_given(OneStateModel=environment.is_one_state_model),
        },
        **_given(SharedCode=_code(environment.shared_code)),
        **_given(SharedMappingCode=_code(environment.shared_mapping_code)),
        "GlobalVariableTypes": [*enums, *map(_compound, environment.compounds)],
        "GlobalVariablesDeclaration": [_variable(variable) for variable in environment.variables],
        "InitialBeliefStateAssignments": _block(environment.initial_belief),
        "SpecialStates": [_special_state(special) for special in environment.special_states],
        "ExtrinsicChangesDynamicModel": _block(environment.extrinsic_changes),
        **_given(
            HeuristicStateValue=_block(environment.state_heuristic),
            PrintStateFunc=_block(environment.print_state),
            Monitors=[
                {"Name": monitor.name, "AssignmentCode": _code(monitor.code[0].code)}
                for monitor in environment.monitors
            ],
        ),
    }


def _compound(compound: documents.CompoundType) -> dict[str, Any]:
    fields = [
        {
            "Name": field.name,
            "Type": field.type,
            **_given(Default=_code(field.default), UnderlineLocalVariableType=field.low_level_type),
        }
        for field in compound.fields
    ]
    return {"TypeName": compound.name, "Type": "compound", "Variables": fields}


def _variable(variable: documents.StateVariable) -> dict[str, Any]:
    return {
        "Name": variable.name,
        "Type": variable.type,
        **_given(
            IsArray=variable.is_array,
            IndexedBy=variable.index_enum,
            IsActionParameterValue=variable.is_parameter_value,
            IsMissionParameter=variable.is_mission_parameter,
            Parameters=list(variable.key_types),
            UnderlineLocalVariableType=variable.low_level_type,
            Default=_code(variable.default_value),
            DefaultCode=_code(variable.default_code),
        ),
    }


def _special_state(special: documents.SpecialState) -> dict[str, Any]:
    if special.condition is None:
        return {"StateFunctionCode": _block(special.code)}
    failure = {} if special.is_failure is None else {"IsFailureState": special.is_failure}
    return {
        "StateConditionCode": _code(special.condition),
        "Reward": special.reward,
        **_given(IsGoalState=special.is_goal, IsOneTimeReward=special.is_one_time),
        **failure,
    }


def _low_level(document: documents.LowLevelDocument) -> dict[str, Any]:
    return {
        "LocalVariableTypes": [
            {"TypeName": kind.name, "Variables": _parameters(kind.fields)} for kind in document.types
        ],
        "Constants": [
            {"Name": constant.name, "Type": constant.type, "InitCode": _code(constant.code)}
            for constant in document.constants
        ],
    }


# --- skill document ---


def _skill(model: documents.SkillModel) -> dict[str, Any]:
    preconditions = _given(
        GlobalVariablePreconditionAssignments=_block(model.precondition),
        PlannerAssistancePreconditionsAssignments=_block(model.rollout_policy),
        ViolatingPreconditionPenalty=model.violation_penalty,
    )
    given_observation = _block(model.state_given_observation)
    return {
        "GlobalVariableModuleParameters": _parameters(model.parameters),
        **_given(
            PossibleParametersValue=_block(model.possible_parameters),
            Preconditions=preconditions,
            ModuleExecutionTimeDynamicModel=_block(model.execution_time),
        ),
        "DynamicModel": {"NextStateAssignments": _block(model.dynamic_model)},
        **_given(StateGivenObservationModel=_given(Assignments=given_observation)),
    }


def _parameters(parameters: Iterable[documents.Parameter]) -> list[dict[str, str]]:
    return [{"Name": parameter.name, "Type": parameter.type} for parameter in parameters]


# --- abstraction mapping ---


def _mapping(mapping: documents.AbstractionMapping) -> dict[str, Any]:
    calls = {"Monitor": mapping.monitor} if mapping.monitor else _activation(mapping.activation)
    return {
        "GlueFramework": "ROS",
        "ModuleResponse": {
            "ResponseRules": [_rule(rule) for rule in mapping.rules],
            **_given(FromStringLocalVariable=mapping.response_variable),
        },
        **calls,
        **_given(StopWhen=_code(mapping.stop_when)),
        "LocalVariablesInitialization": [_local_variable(variable) for variable in mapping.local_variables],
    }


def _activation(activation: documents.Activation) -> dict[str, Any]:
    service = {
        **_given(ImportCode=_imports(activation.imports)),
        "ServicePath": activation.path,
        **_given(ServiceName=activation.service_type),
        "ServiceParameters": [
            {"ServiceFieldName": field.name, "AssignServiceFieldCode": _code(field.value)}
            for field in activation.fields
        ],
    }
    kind = documents.ACTIVATION_KINDS[activation.kind]
    return {"ModuleActivation": {kind: service, **_given(MaxDuration=activation.max_duration_s)}}


def _rule(rule: documents.ResponseRule) -> dict[str, Any]:
    assigned = [
        {"VarName": assignment.path, "Value": _code(assignment.value)} for assignment in rule.assignments
    ]
    return {
        "Response": rule.response,
        "ConditionCodeWithLocalVariables": _code(rule.condition) or "",
        **_given(AssignGlobalVariables=assigned),
    }


def _local_variable(variable: documents.LocalVariable) -> dict[str, Any]:
    is_parameter = variable.source is documents.LocalSource.PARAMETER
    return {
        "InputLocalVariable" if is_parameter else "LocalVariableName": variable.name,
        **_given(
            FromGlobalVariable=variable.parameter_path,
            FromROSServiceResponse=variable.source is documents.LocalSource.SERVICE_RESPONSE,
            RosTopicPath=variable.topic,
            TopicMessageType=variable.message_type,
            VariableType=variable.type,
            InitialValue=_code(variable.initial_value),
            ImportCode=_imports(variable.imports),
            IsHeavyVariable=variable.is_heavy,
            AssignmentCode=_code(variable.code),
        ),
    }


def _imports(imports: Iterable[documents.Import]) -> list[dict[str, Any]]:
    return [{**_given(From=item.module), "Import": list(item.names)} for item in imports]


# --- code ---


def _block(block: Iterable[documents.Assignment]) -> list[dict[str, Any]]:
    return [
        _given(
            AssignmentName=assignment.name,
            TempVar=_temporary(assignment.temporary) if assignment.temporary is not None else None,
            IteratePreviousStateVars=_loops(assignment.over_previous),
            IterateNextStateVars=_loops(assignment.over_next),
            AssignmentCode=_code(assignment.code),
        )
        for assignment in block
    ]


def _temporary(temporary: documents.TemporaryVariable) -> dict[str, Any]:
    return {
        "VarName": temporary.name,
        "Type": temporary.type,
        **_given(EnumName=temporary.enum_name, EnumValues=list(temporary.enum_values)),
    }


def _loops(loops: Iterable[documents.Iteration]) -> list[dict[str, Any]]:
    return [
        {
            "Type": loop.type,
            "ItemName": loop.item,
            **_given(ConditionCode=_code(loop.condition), WhenConditionTrueCode=_code(loop.body)),
        }
        for loop in loops
    ]


def _code(snippet: documents.Snippet | None) -> str | list[str] | None:
    """A line as text, several as a list of lines."""
    if snippet is None:
        return None
    lines = snippet.code.split("\n")
    return snippet.code if len(lines) == 1 else lines
