from textwrap import dedent

from aos_language.findings import Findings
from aos_language.reading.files import read_documents
from aos_middleware.emission.emit import EmittedMapping, emit_mapping
from aos_protocol.diagnostics import Span
from aos_protocol.documents import AbstractionMapping, LowLevelDocument, Skill, SkillModel


def mapping_of(text: str, file: str = "look.am") -> AbstractionMapping:
    findings = Findings()
    documents = read_documents({file: dedent(text).encode()}, findings)
    mapping = documents[file].content
    assert isinstance(mapping, AbstractionMapping), findings.sorted()
    return mapping


def skill_of(text: str, file: str = "look.am") -> Skill:
    """A skill with a mapping from text; its model is not used."""
    mapping = mapping_of(text, file)
    return Skill(SkillModel(mapping.project, mapping.name, Span(file)), mapping)


def emitted(text: str, low_level: LowLevelDocument | None = None) -> EmittedMapping:
    return emit_mapping(skill_of(text), low_level)
