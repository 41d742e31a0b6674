"""Documents put together to a project: one environment, each skill with its model and its mapping.

A skill without a written mapping gets a derived one. A parameter that is an enum gets all of its values.
"""

from collections.abc import Mapping, Set

import msgspec
from msgspec.structs import replace

from aos_language.derived_mapping import derived_mapping
from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind
from aos_protocol.diagnostics import Span
from aos_protocol.documents import (
    AbstractionMapping,
    Environment,
    LowLevelDocument,
    Project,
    Skill,
    SkillModel,
)
from aos_protocol.spelling import nearest


class Assembly(msgspec.Struct):
    """The parts of a project that a bundle's documents make together, complete or not."""

    environment: Environment | None = None
    models: dict[str, SkillModel] = {}
    mappings: dict[str, AbstractionMapping] = {}
    monitors: dict[str, AbstractionMapping] = {}
    low_level: LowLevelDocument | None = None
    has_unread_files: bool = False

    def project(self) -> Project | None:
        """The project; None where the environment or a mapping's skill is missing."""
        if self.environment is None or not self.models or self.models.keys() != self.mappings.keys():
            return None
        skills = tuple(Skill(self.models[name], self.mappings[name]) for name in sorted(self.models))
        monitors = tuple(sorted(self.monitors.values(), key=lambda mapping: mapping.monitor))
        return Project(self.environment.project, self.environment, skills, self.low_level, monitors=monitors)


def assemble(
    documents: Mapping[str, Document], findings: Findings, *, bundle: str, has_unread_files: bool
) -> Assembly:
    """Puts documents together; reports duplicates, mixed projects and what is missing.

    `bundle` is the place of what has no file. With files that could not be read nothing counts as missing.
    """
    unique = _without_duplicates(documents, findings)
    _check_projects(documents, findings)
    assembly = Assembly(has_unread_files=has_unread_files)
    for document in unique.values():
        match document.content:
            case Environment() as environment:
                assembly.environment = environment
            case LowLevelDocument() as low_level:
                assembly.low_level = low_level
            case SkillModel() as model if document.name:
                assembly.models[document.name] = model
            case AbstractionMapping() as mapping if mapping.monitor and document.name:
                assembly.monitors[document.name] = mapping
            case AbstractionMapping() as mapping if document.name:
                assembly.mappings[document.name] = mapping
    if assembly.environment is not None:
        enums, compounds = assembly.environment.enums, assembly.environment.compounds
        types = {enum.name for enum in enums} | {compound.name for compound in compounds}
        assembly.models = {
            name: _with_types_first(model, types, findings) for name, model in assembly.models.items()
        }
    written = {name for kind, name in unique if kind is DocumentKind.MAPPING}
    others_have = bool(written & assembly.models.keys()) and not has_unread_files
    for name in sorted(assembly.models.keys() - written):
        mapping = derived_mapping(assembly.models[name], assembly.environment)
        if others_have and (mapping.rules or mapping.response_variable):
            message = f"{name} has no abstraction mapping, which others have: it gets a derived one"
            hint = f"It is called as `/{name}`, and the field `response` of its result is the response"
            findings.remark("AOS114", message, mapping.span, hint)
        assembly.mappings[name] = mapping
    if not has_unread_files:
        _check_complete(unique, findings, Span(bundle))
    return assembly


def _with_types_first(model: SkillModel, types: Set[str], findings: Findings) -> SkillModel:
    """The skill with each parameter whose name stands before its type told, and read as meant."""
    parameters = []
    for each in model.parameters:
        if each.name in types and each.type.isidentifier() and each.type not in types:
            findings.error("AOS104", f"the type comes first: `{each.name} {each.type}`", each.span)
            each = replace(each, name=each.type, type=each.name)
        parameters.append(each)
    return replace(model, parameters=tuple(parameters))


def _without_duplicates(
    documents: Mapping[str, Document], findings: Findings
) -> dict[tuple[DocumentKind, str], Document]:
    unique: dict[tuple[DocumentKind, str], Document] = {}
    for document in documents.values():
        first = unique.setdefault(document.identity, document)
        if first is document or (not document.name and document.kind is not DocumentKind.ENVIRONMENT):
            continue
        title = document.kind.value
        if document.kind in (DocumentKind.SKILL, DocumentKind.MAPPING):
            title += f" of {document.name}"
        hint = f"The first is {first.span.file}; take one of them out"
        findings.error("AOS111", f"a second {title}", document.span, hint)
    return unique


def _check_projects(documents: Mapping[str, Document], findings: Findings) -> None:
    """All documents are of the environment's project, or else of that of the first file."""
    named = [document for document in documents.values() if document.project]
    leading = next((d for d in named if d.kind is DocumentKind.ENVIRONMENT), next(iter(named), None))
    others = [d for d in named if d is not leading]
    if len(others) > 1 and len({d.project for d in others}) == 1:
        leading = others[0]  # One name that all others do not have is the wrong one.
    for document in named:
        if leading is not None and document.project != leading.project:
            message = f"this document is of project {document.project}, not of {leading.project}"
            hint = f"{leading.span.file} says {leading.project}"
            findings.error("AOS113", message, document.project_span or document.span, hint)


def _monitors(document: Document) -> bool:
    return isinstance(document.content, AbstractionMapping) and bool(document.content.monitor)


def _check_complete(
    unique: Mapping[tuple[DocumentKind, str], Document], findings: Findings, bundle: Span
) -> None:
    by_kind = {
        kind: {
            name for (other, name), document in unique.items() if other is kind and not _monitors(document)
        }
        for kind in DocumentKind
    }
    if not by_kind[DocumentKind.ENVIRONMENT]:
        hint = "Add an .ef file, or a JSON document of type Environment"
        findings.error("AOS115", "there is no environment document", bundle, hint)
    skills, mappings = by_kind[DocumentKind.SKILL], by_kind[DocumentKind.MAPPING]
    for name in sorted(mappings - skills):
        span = unique[DocumentKind.MAPPING, name].span
        # A skill whose mapping is missed is the likeliest one to be meant.
        meant = nearest(name, sorted(skills - mappings)) or nearest(name, sorted(skills))
        hint = f"Did you mean `{meant}`?" if meant else f"Add {name}.sd, or a JSON document of type PLP"
        message = f"the abstraction mapping {name} has no skill document"
        if meant in skills - mappings:
            message += f", and the skill {meant} has no mapping"
        findings.error("AOS114", message, span, hint)
    if not skills and not mappings:
        findings.error("AOS105", "there are no skills", bundle, "Add .sd files")
