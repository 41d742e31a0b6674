"""A JSON file to a document: the header decides, in the paper's spelling (`GsdlMain`) or that of AOS 1.x."""

import re

from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind, check_name, read_version
from aos_language.reading.json_environment import read_environment, read_low_level
from aos_language.reading.json_mapping import read_mapping
from aos_language.reading.json_record import Record
from aos_language.reading.json_skill import read_skill
from aos_language.reading.json_text import JsonObject, parse_json
from aos_language.reading.source import Source, Text
from aos_protocol.documents import Content
from aos_protocol.spelling import nearest

_HEADERS = ("PlpMain", "GsdlMain")
_KINDS = {
    "Environment": DocumentKind.ENVIRONMENT,
    "PLP": DocumentKind.SKILL,
    "GSDL": DocumentKind.SKILL,
    "SD": DocumentKind.SKILL,
    "Glue": DocumentKind.MAPPING,
    "AM": DocumentKind.MAPPING,
    "EnvironmentGlue": DocumentKind.LOW_LEVEL,
}
_SECTIONS = frozenset({
    "DynamicModel", "EnvironmentGeneral", "ExtrinsicChangesDynamicModel", "GlobalVariableModuleParameters",
    "GlobalVariableTypes", "GlobalVariablesDeclaration", "GlueFramework", "InitialBeliefStateAssignments",
    "LocalVariableTypes", "LocalVariablesInitialization", "ModuleActivation", "ModuleResponse",
    "Preconditions", "SpecialStates",
})  # fmt: skip
_RUN_RESULT = ("ExecutionOutcome", "InitialBeliefeState", "ISODate(")


def read_json(source: Source, findings: Findings) -> Document | None:
    """The document of a file; None where it is none, or cannot be read."""
    if _is_run_result(source):
        hint = "Move it out of the bundle"
        findings.error("AOS107", "this is the result of a run, not a document", source.span(), hint)
        return None
    has_header = re.search(rf"\b(?:{'|'.join(_HEADERS)})\b", source.text) is not None
    is_document = has_header or any(f'"{word}"' in source.text for word in _SECTIONS)
    value = parse_json(source, findings if is_document else Findings())
    if not isinstance(value, JsonObject):
        if not is_document:
            _not_a_document(source, findings)
        elif value is not None:
            findings.error("AOS106", "a document is one JSON object", source.span())
        return None
    record = Record(source, value, "a document", findings)
    header = next((key for key in _HEADERS if record.has(key)), None)
    if header is None:
        _without_header(record, value, findings)
        return None
    return _read(record, header, source, findings)


def _is_run_result(source: Source) -> bool:
    return not any(f'"{word}"' in source.text for word in _HEADERS) and any(
        word in source.text for word in _RUN_RESULT
    )


def _not_a_document(source: Source, findings: Findings) -> None:
    findings.warning("AOS107", "this is not an AOS document", source.span(), "It is left out")


def _without_header(record: Record, value: JsonObject, findings: Findings) -> None:
    for key, part in value.members:
        if isinstance(part, JsonObject) and (close := nearest(key.text, _HEADERS)):
            span = record.source.span(key.start + 1)
            findings.unknown(key.text, (close,), f'unknown key "{key.text}"', span, code="AOS102")
            return
    if any(key.text in _SECTIONS for key, _ in value.members):
        hint = 'Add "PlpMain": {"Project": ..., "Name": ..., "Type": ...}'
        findings.error("AOS105", 'this document has no "PlpMain"', record.span, hint)
    else:
        _not_a_document(record.source, findings)


def _read(record: Record, header_key: str, source: Source, findings: Findings) -> Document | None:
    header = record.record(header_key, header_key, required=True)
    if header is None:
        return None
    project = header.text("Project", required=True)
    kind_name = header.text("Type", required=True)
    name = header.text("Name")
    header.ignore("Version", "Comment")
    version = read_version(header.text("Version") if header.is_text("Version") else None, findings)
    header.finish()
    if kind_name is None:
        return None
    kind = _KINDS.get(kind_name.text)
    if kind is None:
        message = f"unknown kind of document {kind_name.text!r}"
        otherwise = f"It is one of {', '.join(_KINDS)}"
        findings.unknown(kind_name.text, _KINDS, message, kind_name.span, otherwise, code="AOS106")
        return None
    record.what = f"the {kind.value}"
    name = name or _skill_name(header, kind, findings)
    document = _document(record, kind, project, name, version, findings)
    record.ignore("Comment")
    record.finish()
    return document


def _skill_name(header: Record, kind: DocumentKind, findings: Findings) -> Text | None:
    if kind in (DocumentKind.ENVIRONMENT, DocumentKind.LOW_LEVEL):
        return Text("environment", header.span)
    findings.error("AOS105", f'the {kind} lacks "Name"', header.span)
    return None


def _document(
    record: Record,
    kind: DocumentKind,
    project: Text | None,
    name: Text | None,
    version: Text | None,
    findings: Findings,
) -> Document:
    project_name = project.text if project else ""
    is_skill = kind in (DocumentKind.SKILL, DocumentKind.MAPPING)
    has_name = name is not None and (not is_skill or check_name(name, "a skill", findings))
    title = name.text if name is not None and has_name else ""
    span = name.span if name is not None else record.span
    content: Content | None
    match kind:
        case DocumentKind.ENVIRONMENT:
            content = read_environment(record, project_name, span)
        case DocumentKind.LOW_LEVEL:
            content = read_low_level(record, project_name, span)
        case DocumentKind.SKILL:
            content = read_skill(record, project_name, title, span)
        case DocumentKind.MAPPING:
            content = read_mapping(record, project_name, title, span)
    return Document(kind, project_name, title, span, content, version, project.span if project else None)
