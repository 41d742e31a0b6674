"""The skill document in JSON (`PLP`, in the paper `GSDL`)."""

from aos_language.reading.document import check_name, check_penalty, normal_type
from aos_language.reading.json_blocks import read_block
from aos_language.reading.json_record import Record
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Assignment, Parameter, SkillModel


def read_skill(record: Record, project: str, name: str, span: Span) -> SkillModel:
    """The skill's model; what cannot be read of it is reported and left out."""
    precondition, rollout_policy, penalty = _preconditions(record, name)
    dynamic = record.record("DynamicModel", "DynamicModel", required=True)
    given = record.record("StateGivenObservationModel", "StateGivenObservationModel")
    for key in ("RequiredResources", "ModuleResponse", "LocalVariablesInitializationFromGlobalVariables"):
        record.obsolete(key, "It was dropped from the language")
    return SkillModel(
        project=project,
        name=name,
        span=span,
        parameters=_parameters(record),
        possible_parameters=read_block(record, "PossibleParametersValue"),
        precondition=precondition,
        rollout_policy=rollout_policy,
        violation_penalty=penalty,
        execution_time=read_block(record, "ModuleExecutionTimeDynamicModel"),
        dynamic_model=_only_block(dynamic, "NextStateAssignments"),
        state_given_observation=_only_block(given, "Assignments"),
    )


def _only_block(record: Record | None, key: str) -> tuple[Assignment, ...]:
    if record is None:
        return ()
    block = read_block(record, key)
    record.finish()
    return block


def _preconditions(
    record: Record, skill: str
) -> tuple[tuple[Assignment, ...], tuple[Assignment, ...], float]:
    group = record.record("Preconditions", "Preconditions")
    if group is None:
        return (), (), 0.0
    precondition = read_block(group, "GlobalVariablePreconditionAssignments")
    rollout_policy = read_block(group, "PlannerAssistancePreconditionsAssignments")
    penalty = group.number("ViolatingPreconditionPenalty")
    if penalty is None and group.has("ViolatingPreconditionPenalty"):
        penalty = -1.0  # That it cannot be read is told; it is not taken for none.
    check_penalty(skill, penalty or 0.0, group.value_span("ViolatingPreconditionPenalty"), group.findings)
    group.finish()
    return precondition, rollout_policy, penalty or 0.0


def _parameters(record: Record) -> tuple[Parameter, ...]:
    found = []
    for item in record.records("GlobalVariableModuleParameters", "a parameter"):
        name, kind = item.text("Name", required=True), item.text("Type", required=True)
        item.ignore("Comment")
        item.finish()
        if name and kind:
            check_name(name, "a parameter", record.findings)
            type_name = normal_type(kind, record.findings)
            found.append(Parameter(name.text, type_name, name.span, kind.span))
    return tuple(found)
