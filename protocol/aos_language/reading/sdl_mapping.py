"""The abstraction mapping (`.am`)."""

import re
from itertools import pairwise

from msgspec.structs import replace

from aos_language.reading.document import check_name, normal_type
from aos_language.reading.local_variable import LocalVariableParts, build_local_variable
from aos_language.reading.sdl_declaration import read_number, read_truth
from aos_language.reading.sdl_sections import Sections
from aos_language.reading.sdl_text import Part, Section
from aos_language.reading.source import Text
from aos_protocol import documents
from aos_protocol.diagnostics import Span

_IMPORT = re.compile(r"(?:from(?:\s*:\s*|\s+)(?P<module>\S+)\s+)?import(?:\s*:\s*|\s+)(?P<names>.+)")
_COLON_AFTER_WORD = re.compile(r"(?:from\s*:.*\s)?import\s*:")


def read_mapping(
    sections: Sections, project: str, name: str, span: Span
) -> documents.AbstractionMapping | None:
    """The mapping; None where the activation cannot be read."""
    rules = [_rule(section) for section in sections.all("response")]
    variables = [_local_variable(section) for section in sections.all("local_variable")]
    text_response = sections.last("response_local_variable")
    stop_when = _stop_when(sections)
    monitor = sections.last("monitor")
    activation = _calls(sections, monitor, name)
    if activation is None:
        return None
    return documents.AbstractionMapping(
        project=project,
        name=name,
        span=span,
        activation=activation,
        rules=tuple(rule for rule in rules if rule is not None),
        response_variable=text_response.value.text if text_response is not None else "",
        local_variables=tuple(variable for variable in variables if variable is not None),
        response_variable_span=text_response.value.span if text_response is not None else None,
        stop_when=stop_when,
        monitor=monitor.value.text if monitor is not None else "",
    )


def _calls(sections: Sections, monitor: Section | None, name: str) -> documents.Activation | None:
    """The activation; that of a monitor calls nothing, and is where the monitor is named."""
    section = sections.last("module_activation")
    if monitor is not None:
        if section is not None:
            message = "a mapping is that of a monitor or calls a skill, not both"
            section.error("AOS106", message, "Take one of the two out")
        if not monitor.value.text:
            hint = "It is that of a `monitor:` of the environment document"
            monitor.error("AOS105", "`monitor:` needs a name", hint)
            return None
        return replace(documents.NO_ACTIVATION, span=monitor.value.span)
    if section is None:
        hint = "A mapping without a skill says `monitor: NAME` instead"
        sections.findings.error(
            "AOS105", f"the mapping {name} lacks `module_activation:`", sections.span, hint
        )
        return None
    return _activation(section)


def _stop_when(sections: Sections) -> documents.Snippet | None:
    section = sections.last("stop_when")
    if section is None:
        return None
    expression = section.expression()
    if expression is None:
        hint = "Write a Python expression over local variables behind it"
        section.error("AOS105", "`stop_when:` has no expression", hint)
    return expression


def _rule(section: Section) -> documents.ResponseRule | None:
    rule = section.last("response_rule")
    condition = rule.expression() if rule is not None else None
    if rule is None:
        hint = "Write `response_rule: True` for a response that always holds"
        section.error("AOS105", f"the response {section.value.text} has no rule", hint)
    if not section.value.text:
        section.error("AOS105", "`response:` needs a name")
        return None
    check_name(section.value, "a response", section.findings)
    assignments = _assignments(section)
    return documents.ResponseRule(section.value.text, condition, section.value.span, assignments)


def _assignments(section: Section) -> tuple[documents.LowLevelAssignment, ...]:
    """Each `assign_variable:` with the `value:` after it."""
    parts = [part for part in section.parts if part.word in ("assign_variable", "value")]
    assignments = []
    for part, following in pairwise([*parts, None]):
        if part is None or part.word == "value":
            continue
        value = following.expression() if following is not None and following.word == "value" else None
        if value is None:
            hint = "Add `value:` with a Python expression below it"
            message = f"the low-level assignment to {part.value.text or '(nothing)'} has no value"
            part.error("AOS105", message, hint)
        else:
            assignments.append(documents.LowLevelAssignment(part.value.text, value, part.value.span))
    return tuple(assignments)


def _activation(section: Section) -> documents.Activation | None:
    kind = section.value.text.lower()
    if kind not in documents.ACTIVATION_KINDS:
        name, span = section.value.text, section.value.span if kind else section.span
        otherwise = f"It is one of {', '.join(documents.ACTIVATION_KINDS)}"
        message = f"unknown activation {name!r}"
        section.findings.unknown(name, documents.ACTIVATION_KINDS, message, span, otherwise, code="AOS106")
        return None
    path, service = section.last("path"), section.last("srv")
    duration = section.last("max_duration")
    fields = _fields(section)
    imports = _imports(section)
    max_duration_s = read_number(duration) if duration is not None else None
    if duration is not None and max_duration_s is not None and max_duration_s <= 0.0:
        section.findings.error("AOS106", "the longest duration must be above 0 s", duration.value.span)
    if kind != "skill" and service is None:
        section.error("AOS105", f"a {kind} needs `srv:`, its type")
    if path is None or not path.value.text:
        section.error("AOS105", "the activation needs `path:`")
        return None
    return documents.Activation(
        kind=kind,
        path=path.value.text,
        span=path.value.span,
        service_type=service.value.text if service is not None else "",
        fields=fields,
        imports=imports,
        max_duration_s=max_duration_s,
    )


def _fields(section: Section) -> tuple[documents.ActivationField, ...]:
    """Each `parameter:` with the `code:` below it."""
    fields: list[documents.ActivationField] = []
    pending: Part | None = None
    for part in section.parts:
        if part.word == "parameter":
            _without_code(pending)
            pending = part
        elif part.word == "code":
            value = part.expression()
            if pending is None:
                part.error("AOS104", "this `code:` belongs to no `parameter:`")
            elif value is not None and check_name(pending.value, "a service field", section.findings):
                fields.append(documents.ActivationField(pending.value.text, value))
            elif value is None:
                _without_code(pending)
            pending = None
    _without_code(pending)
    return tuple(fields)


def _without_code(pending: Part | None) -> None:
    if pending is not None:
        hint = "Add `code:` with a Python expression below it"
        pending.error("AOS105", f"the field {pending.value.text} has no value", hint)


def _imports(section: Section) -> tuple[documents.Import, ...]:
    found = []
    for part in section.all("imports"):
        match = _IMPORT.fullmatch(part.value.text)
        if match is None:
            hint = "Write `imports: from: <module> import: <name>, <name>`"
            section.findings.error("AOS104", "this import cannot be read", part.value.span, hint)
            continue
        if _COLON_AFTER_WORD.match(part.value.text) is None:
            hint = "AOS writes `from: <module> import: <name>`"
            section.findings.warning("AOS127", "an import as Python writes it", part.value.span, hint)
        names = tuple(name.strip() for name in match["names"].split(",") if name.strip())
        found.append(documents.Import(match["module"] or "", names, part.span))
    return tuple(found)


def _local_variable(section: Section) -> documents.LocalVariable | None:
    def value(word: str) -> Text | None:
        part = section.last(word)
        return part.value if part is not None and part.value.text else None

    kind = value("type")
    initial = section.last("initial_value")
    from_service = section.last("from_ros_service_response")
    parts = LocalVariableParts(
        name=section.value if section.value.text else None,
        span=section.span,
        type=normal_type(kind, section.findings) if kind else "",
        parameter_path=value("action_parameter"),
        is_from_service=read_truth(from_service, otherwise=True),
        service_span=from_service.span if from_service is not None else None,
        topic=value("topic"),
        message_type=value("message_type"),
        initial_value=initial.expression() if initial is not None else None,
        code=section.code_of("code"),
        imports=_imports(section),
        is_heavy=read_truth(section.last("is_heavy_variable")),
    )
    return build_local_variable(parts, section.findings)
