"""The low-level file (`.lf`): the Python values behind `anyValue`. AOS 2.0 has no such file; it is ours."""

import re

from aos_language.reading.document import check_name
from aos_language.reading.sdl_sections import Sections
from aos_language.reading.sdl_text import Part, Section
from aos_language.reading.source import Text
from aos_protocol.diagnostics import Span
from aos_protocol.documents import LowLevelConstant, LowLevelDocument, LowLevelType, Parameter

_TYPE_AND_NAME = re.compile(r"(\S.*?)\s+(\S+)")


def read_low_level(sections: Sections, project: str, span: Span) -> LowLevelDocument:
    """The low-level types and constants; what cannot be read is reported and left out."""
    types = [_type(section) for section in sections.all("define_type")]
    constants = [_constant(section) for section in sections.all("constant")]
    return LowLevelDocument(
        project,
        span,
        tuple(kind for kind in types if kind is not None),
        tuple(constant for constant in constants if constant is not None),
    )


def _type(section: Section) -> LowLevelType | None:
    if not section.value.text:
        section.error("AOS105", "`define_type:` needs a name")
        return None
    if not check_name(section.value, "a low-level type", section.findings):
        return None
    fields = []
    for part in section.all("variable"):
        declared = _type_and_name(part)
        if declared is not None and check_name(declared[1], "a field", section.findings):
            fields.append(Parameter(declared[1].text, declared[0], declared[1].span))
    return LowLevelType(section.value.text, tuple(fields), section.value.span)


def _constant(section: Section) -> LowLevelConstant | None:
    declared = _type_and_name(section)
    code = section.code_of("code")
    if code is None:
        section.error("AOS105", "a low-level constant needs `code:` that sets it")
    if declared is None or code is None:
        return None
    kind, name = declared
    return LowLevelConstant(name.text, kind, code, name.span)


def _type_and_name(part: Part) -> tuple[str, Text] | None:
    match = _TYPE_AND_NAME.fullmatch(part.value.text)
    if match is None:
        span = part.place
        part.findings.error("AOS104", f"`{part.word}:` needs a type and a name", span)
        return None
    return match.group(1), Text(match.group(2), part.value.after(match.start(2)).span)
