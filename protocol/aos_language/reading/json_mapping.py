"""The abstraction mapping in JSON (`Glue`, in the paper `AM`)."""

from msgspec.structs import replace

from aos_language.findings import Findings
from aos_language.reading.document import check_name, normal_type
from aos_language.reading.json_record import Record
from aos_language.reading.local_variable import JSON_SOURCES, LocalVariableParts, build_local_variable
from aos_language.reading.source import Text, dedented
from aos_protocol import documents
from aos_protocol.diagnostics import Span


def read_mapping(record: Record, project: str, name: str, span: Span) -> documents.AbstractionMapping | None:
    """The mapping; None where the activation cannot be read."""
    record.ignore("GlueFramework")
    rules, variable = _responses(record)
    stop_when = record.python_expression("StopWhen")
    locals_ = [_local_variable(item) for item in record.records("LocalVariablesInitialization", "a variable")]
    monitor = record.text("Monitor")
    activation = _activation(record) if monitor is None else _of_monitor(record, monitor)
    if activation is None:
        return None
    return documents.AbstractionMapping(
        project=project,
        name=name,
        span=span,
        activation=activation,
        rules=rules,
        response_variable=variable.text if variable else "",
        local_variables=tuple(local for local in locals_ if local is not None),
        response_variable_span=variable.span if variable else None,
        stop_when=stop_when,
        monitor=monitor.text if monitor is not None else "",
    )


def _of_monitor(record: Record, monitor: Text) -> documents.Activation:
    """The activation of a monitor, which calls nothing, and is where the monitor is named."""
    if record.has("ModuleActivation"):
        message = "a mapping is that of a monitor or calls a skill, not both"
        span = record.key_span("ModuleActivation")
        record.findings.error("AOS106", message, span, "Take one of the two out")
        _activation(record)
    return replace(documents.NO_ACTIVATION, span=monitor.span)


def _responses(record: Record) -> tuple[tuple[documents.ResponseRule, ...], Text | None]:
    group = record.record("ModuleResponse", "ModuleResponse")
    if group is None:
        return (), None
    rules = []
    for item in group.records("ResponseRules", "a response rule"):
        response = item.text("Response", required=True)
        condition = item.python_expression("ConditionCodeWithLocalVariables")
        item.ignore("Comment")
        assignments = _assignments(item)
        item.finish()
        if response:
            check_name(response, "a response", record.findings)
            rules.append(documents.ResponseRule(response.text, condition, response.span, assignments))
    variable = group.text("FromStringLocalVariable")
    group.ignore("Comment")
    group.obsolete("EnumResponse", "The response rules name the responses")
    group.finish()
    return tuple(rules), variable


def _assignments(rule: Record) -> tuple[documents.LowLevelAssignment, ...]:
    assignments = []
    for item in rule.records("AssignGlobalVariables", "a low-level assignment"):
        path = item.text("VarName", required=True)
        value = item.python_expression("Value")
        item.finish()
        if value is None:
            item.findings.error("AOS105", 'a low-level assignment lacks "Value"', item.span)
        elif path is not None:
            assignments.append(documents.LowLevelAssignment(path.text, value, path.span))
    return tuple(assignments)


def _activation(record: Record) -> documents.Activation | None:
    group = record.record("ModuleActivation", "ModuleActivation", required=True)
    if group is None:
        return None
    max_duration_s = group.number("MaxDuration")
    if max_duration_s is not None and max_duration_s <= 0.0:
        message = "the longest duration must be above 0 s"
        record.findings.error("AOS106", message, group.value_span("MaxDuration"))
    given = {
        kind: service
        for kind, word in documents.ACTIVATION_KINDS.items()
        if (service := group.record(word, word))
    }
    if not given:
        group.lack(*documents.ACTIVATION_KINDS.values())
    group.finish()
    if not given:
        message, hint = ('ModuleActivation lacks "RosService"', 'Or "RosAction", or "Skill" if it is neither')
        record.findings.error("AOS105", message, group.span, hint)
        return None
    kind, service = next(iter(given.items()))
    path = service.text("ServicePath", required=True)
    service_type = service.text("ServiceName", required=kind != "skill")
    fields = _fields(service)
    imports = _imports(service)
    service.finish()
    if path is None:
        return None
    return documents.Activation(
        kind=kind,
        path=path.text,
        span=path.span,
        service_type=service_type.text if service_type else "",
        fields=fields,
        imports=imports,
        max_duration_s=max_duration_s,
    )


def _fields(record: Record) -> tuple[documents.ActivationField, ...]:
    fields = []
    for item in record.records("ServiceParameters", "a service parameter"):
        name = item.text("ServiceFieldName", required=True)
        value = item.python_expression("AssignServiceFieldCode")
        item.ignore("Comment")
        item.finish()
        if value is None:
            record.findings.error("AOS105", 'a service parameter lacks "AssignServiceFieldCode"', item.span)
        elif name and check_name(name, "a service field", record.findings):
            fields.append(documents.ActivationField(name.text, value))
    return tuple(fields)


def _imports(record: Record) -> tuple[documents.Import, ...]:
    imports = []
    for item in record.records("ImportCode", "an import"):
        module = item.text("From")
        names = item.texts("Import")
        item.finish()
        if names:
            # Several names in one text are what Python's `import a, b` has.
            names_of_item = tuple(
                part.strip() for name in names for part in name.text.split(",") if part.strip()
            )
            imports.append(documents.Import(module.text if module else "", names_of_item, item.span))
        else:
            record.findings.error("AOS105", 'an import lacks "Import"', item.span)
    return tuple(imports)


def _local_variable(record: Record) -> documents.LocalVariable | None:
    name = _name(record)
    parts = LocalVariableParts(
        name=name,
        span=record.span,
        type=_type(record),
        parameter_path=record.text("FromGlobalVariable"),
        is_from_service=record.boolean(
            "FromROSServiceResponse", default=record.has("FromROSServiceResponse")
        ),
        topic=record.text("RosTopicPath"),
        message_type=record.text("TopicMessageType"),
        initial_value=record.python_expression("InitialValue"),
        code=_python(record.code("AssignmentCode")),
        imports=_imports(record),
        is_heavy=record.boolean("IsHeavyVariable"),
    )
    record.ignore("Comment")
    if record.has("RosParameter"):
        message = "values from the ROS parameter server are not supported"
        record.findings.error("AOS124", message, record.key_span("RosParameter"))
        record.ignore("RosParameter")
        return build_local_variable(parts, Findings())  # That it has no source is not told as well.
    if not parts.sources:
        record.lack(*JSON_SOURCES)
    record.finish()
    return build_local_variable(parts, record.findings)


def _name(record: Record) -> Text | None:
    """`LocalVariableName`, or `InputLocalVariable` for a parameter; the paper has the first for both."""
    name, input_name = record.text("LocalVariableName"), record.text("InputLocalVariable")
    return name or input_name


def _type(record: Record) -> str:
    kind = record.text("VariableType")
    return normal_type(kind, record.findings) if kind else ""


def _python(code: documents.Snippet | None) -> documents.Snippet | None:
    return None if code is None else dedented(code)
