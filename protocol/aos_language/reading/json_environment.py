"""The environment document and its Python side (`EnvironmentGlue`), in JSON."""

import re
from collections.abc import Iterator

from msgspec.structs import replace

from aos_language.reading.document import array_type, check_name, enum_type, normal_type
from aos_language.reading.json_blocks import read_block
from aos_language.reading.json_record import Record
from aos_language.reading.source import Text, dedented, guarded
from aos_protocol import documents
from aos_protocol.diagnostics import Span

_RANGE = re.compile(r"\(\s*-?\d+\s*,\s*-?\d+\s*,\s*-?\d+\s*\)")
_KINDS = ("enum", "compound")
_FORM_A = ("StateConditionCode", "Reward", "IsGoalState", "IsFailureState", "IsOneTimeReward")


def read_environment(record: Record, project: str, span: Span) -> documents.Environment:
    """The environment; what cannot be read of it is reported and left out."""
    horizon, discount, is_one_state = _general(record)
    enums, compounds = _types(record)
    variables = (_variable(item) for item in record.records("GlobalVariablesDeclaration", "a variable"))
    specials = (_special_state(item) for item in record.records("SpecialStates", "a special state"))
    return documents.Environment(
        project=project,
        span=span,
        horizon=horizon,
        discount=discount,
        enums=enums,
        compounds=compounds,
        variables=tuple(variable for variable in variables if variable is not None),
        initial_belief=read_block(record, "InitialBeliefStateAssignments"),
        special_states=tuple(special for special in specials if special is not None),
        extrinsic_changes=read_block(record, "ExtrinsicChangesDynamicModel"),
        state_heuristic=read_block(record, "HeuristicStateValue"),
        print_state=read_block(record, "PrintStateFunc"),
        is_one_state_model=is_one_state,
        monitors=tuple(_monitors(record)),
        shared_code=record.code("SharedCode"),
        shared_mapping_code=record.code("SharedMappingCode"),
    )


def _monitors(record: Record) -> Iterator[documents.MonitorModel]:
    for item in record.records("Monitors", "a monitor"):
        name, code = item.text("Name", required=True), item.code("AssignmentCode")
        item.ignore("Comment")
        item.finish()
        if code is None:
            hint = "It sets __moduleResponse from `state`"
            record.findings.error("AOS105", 'a monitor lacks "AssignmentCode"', item.span, hint)
        elif name is not None and check_name(name, "a monitor", record.findings):
            yield documents.MonitorModel(name.text, name.span, (documents.Assignment(code.span, code=code),))


def read_low_level(record: Record, project: str, span: Span) -> documents.LowLevelDocument:
    """The low-level types and constants."""
    types = []
    for item in record.records("LocalVariableTypes", "a low-level type"):
        name = item.text("TypeName", required=True)
        fields = _parameters(item, "Variables", "a field")
        item.finish()
        if name and check_name(name, "a low-level type", record.findings):
            types.append(documents.LowLevelType(name.text, fields, name.span))
    constants = []
    for item in record.records("Constants", "a low-level constant"):
        name, kind = item.text("Name", required=True), item.text("Type", required=True)
        code = item.code("InitCode")
        item.finish()
        if code is None:
            record.findings.error("AOS105", 'a low-level constant lacks "InitCode"', item.span)
        elif name and kind:
            constants.append(documents.LowLevelConstant(name.text, kind.text, dedented(code), name.span))
    return documents.LowLevelDocument(project, span, tuple(types), tuple(constants))


def _general(record: Record) -> tuple[int, float, bool]:
    findings = record.findings
    general = record.record("EnvironmentGeneral", "EnvironmentGeneral", required=True)
    if general is None:
        return 1, 1.0, False
    horizon = general.integer("Horizon", required=True)
    discount = general.number("Discount", required=True)
    is_one_state = general.boolean("OneStateModel")
    general.obsolete("Max_concurrent_actions", "One skill runs at a time")
    general.finish()
    if horizon is not None and not 1 <= horizon <= documents.MAX_HORIZON:
        message = f"the horizon must be from 1 to {documents.MAX_HORIZON}"
        findings.error("AOS106", message, general.value_span("Horizon"))
    if discount is not None and not 0.0 < discount <= 1.0:
        hint = "It must be above 0 and at most 1"
        findings.error("AOS106", f"the discount is {discount:g}", general.value_span("Discount"), hint)
    return horizon or 1, 1.0 if discount is None else discount, is_one_state


def _types(record: Record) -> tuple[tuple[documents.EnumType, ...], tuple[documents.CompoundType, ...]]:
    enums: list[documents.EnumType] = []
    compounds: list[documents.CompoundType] = []
    for item in record.records("GlobalVariableTypes", "a type"):
        name, kind = item.text("TypeName", required=True), item.text("Type", required=True)
        values = item.texts("EnumValues")
        fields = tuple(_field(field) for field in item.records("Variables", "a field"))
        item.ignore("Comment")
        item.finish()
        if name is None or kind is None:
            continue
        check_name(name, "a type", record.findings)
        if kind.text not in _KINDS and kind.text.lower() in _KINDS:
            hint = f"It is read as {kind.text.lower()}"
            record.findings.warning("AOS127", f"the kind {kind.text}", kind.span, hint)
            kind = replace(kind, text=kind.text.lower())
        if kind.text not in _KINDS:
            message = f"a type is an enum or a compound, not {kind.text!r}"
            record.findings.error("AOS106", message, kind.span, "Write `compound` for one with fields")
        if kind.text == "enum" or (values and kind.text not in _KINDS):
            if not values:
                hint = 'They stand in `"EnumValues": [...]`'
                record.findings.error("AOS105", f"the enum {name.text} has no values", name.span, hint)
            enums.append(enum_type(name, values, record.findings))
        else:
            compounds.append(documents.CompoundType(name.text, tuple(f for f in fields if f), name.span))
    return tuple(enums), tuple(compounds)


def _field(record: Record) -> documents.Field | None:
    name, kind = record.text("Name", required=True), record.text("Type", required=True)
    default = record.expression("Default")
    type_name = normal_type(kind, record.findings) if kind else ""
    low_level = _low_level_type(record, type_name)
    record.ignore("ML_IgnoreVariable", "ML_MaxPossibleValue", "Comment")
    record.finish()
    if name is None or kind is None:
        return None
    check_name(name, "a field", record.findings)
    return documents.Field(
        name=name.text,
        type=type_name,
        span=name.span,
        default=default,
        low_level_type=low_level.text if low_level is not None else None,
        type_span=kind.span,
        low_level_span=low_level.span if low_level is not None else None,
    )


def _low_level_type(record: Record, type_name: str) -> Text | None:
    low_level = record.text("UnderlineLocalVariableType")
    if low_level is None:
        return None
    if type_name != "anyValue":
        message = f'"UnderlineLocalVariableType" belongs to anyValue, not to {type_name}'
        record.findings.error("AOS106", message, low_level.span)
    return low_level


def _variable(record: Record) -> documents.StateVariable | None:
    name, kind = record.text("Name", required=True), record.text("Type", required=True)
    value, code = record.expression("Default"), record.code("DefaultCode")
    is_array = record.boolean("IsArray")
    is_parameter_value = record.boolean("IsActionParameterValue")
    is_mission_parameter = record.boolean("IsMissionParameter")
    index = record.text("IndexedBy")
    keys = record.texts("Parameters")
    code = _where_included(record, code)
    type_name = normal_type(kind, record.findings) if kind else ""
    low_level = _low_level_type(record, type_name)
    record.ignore("ML_IgnoreVariable", "ML_MaxPossibleValue", "Comment")
    record.finish()
    if value is not None and code is not None:
        message = 'a variable has "Default" or "DefaultCode", not both'
        record.findings.error("AOS106", message, record.key_span("DefaultCode"))
    if is_parameter_value and is_mission_parameter:
        message = "a variable is a value for action parameters or a mission parameter, not both"
        record.findings.error("AOS106", message, record.key_span("IsMissionParameter"))
    if name is None or kind is None:
        return None
    check_name(name, "a variable", record.findings)
    for key in keys:
        if key.text.startswith("(") and not _RANGE.fullmatch(key.text):
            hint = "Write (start,stop,step)"
            record.findings.error("AOS106", f"{key.text!r} is no range", key.span, hint)
    element, is_array_type, index_enum = array_type(type_name)
    if index is not None:
        index_enum = index.text
    return documents.StateVariable(
        name=name.text,
        type=element,
        span=name.span,
        is_array=is_array or is_array_type or index is not None,
        is_parameter_value=is_parameter_value,
        default_value=value,
        default_code=code,
        key_types=tuple(key.text for key in keys),
        low_level_type=low_level.text if low_level is not None else None,
        low_level_span=low_level.span if low_level is not None else None,
        type_span=kind.span,
        index_enum=index_enum,
        index_span=index.span if index is not None else kind.span if index_enum else None,
        is_mission_parameter=is_mission_parameter,
    )


def _where_included(record: Record, code: documents.Snippet | None) -> documents.Snippet | None:
    """The code of a map variable, for the keys where `IncludeParametersCode` holds."""
    key = "IncludeParametersCode"
    if not record.is_code(key):
        return code if record.boolean(key, default=True) else None
    condition = record.expression(key)
    if condition is None or code is None:
        return code
    message = "keys that a condition leaves out stay in the map, with the type's default"
    record.findings.warning("AOS124", message, record.value_span(key))
    return guarded(condition, code)


def _special_state(record: Record) -> documents.SpecialState | None:
    code = read_block(record, "StateFunctionCode")
    condition = record.expression("StateConditionCode")
    reward = record.number("Reward")
    is_goal, is_one_time = record.boolean("IsGoalState"), record.boolean("IsOneTimeReward")
    is_failure = record.boolean("IsFailureState") if record.has("IsFailureState") else None
    record.ignore("Comment")
    record.finish()
    if record.has("StateFunctionCode"):
        return _form_b(record, code)
    if condition is None:
        record.findings.error("AOS105", 'a special state lacks "StateConditionCode"', record.span)
        return None
    if reward is None:
        if not record.has("Reward"):
            record.findings.error("AOS105", 'a special state lacks "Reward"', record.span)
        reward = 1.0  # The mistake is told. What the condition names is looked at all the same.
    return documents.SpecialState(record.span, condition, reward, is_goal, is_one_time, is_failure)


def _form_b(record: Record, code: tuple[documents.Assignment, ...]) -> documents.SpecialState | None:
    for key in _FORM_A:
        if record.has(key):
            message = f'a special state has "StateFunctionCode" or "{key}", not both'
            record.findings.error("AOS106", message, record.key_span(key))
    return documents.SpecialState(record.span, code=code) if code else None


def _parameters(record: Record, key: str, what: str) -> tuple[documents.Parameter, ...]:
    found = []
    for item in record.records(key, what):
        name, kind = item.text("Name", required=True), item.text("Type", required=True)
        item.finish()
        if name and kind:
            check_name(name, what, record.findings)
            found.append(documents.Parameter(name.text, kind.text, name.span, kind.span))
    return tuple(found)
