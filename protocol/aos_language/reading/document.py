"""The result of a reader: one document with its identity and version."""

import re
from collections.abc import Iterable
from enum import StrEnum

import msgspec

from aos_language.cpp.keywords import COMPILER_NAMES, SPECIAL_NAMES
from aos_language.findings import Findings
from aos_language.reading.source import Text
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Content, EnumType

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}")
_ARRAY = re.compile(r"(.*\S)\s*\[\s*([A-Za-z_]\w*|)\s*\]\s*")
_TYPE_SPELLINGS = {
    "Bool": "bool",
    "boolean": "bool",
    "Int": "int",
    "integer": "int",
    "Float": "float",
    "Double": "double",
    "String": "string",
    "str": "string",
    "std::string": "string",
    "AnyValue": "anyValue",
}


class DocumentKind(StrEnum):
    """The kinds, by the name messages give them."""

    ENVIRONMENT = "environment document"
    SKILL = "skill document"
    MAPPING = "abstraction mapping"
    LOW_LEVEL = "low-level document"


class Document(msgspec.Struct, frozen=True):
    """A document as read. What could not be read is empty, and `content` is None where too much of it is."""

    kind: DocumentKind
    project: str
    name: str
    span: Span
    content: Content | None
    version: Text | None = None
    project_span: Span | None = None

    @property
    def identity(self) -> tuple[DocumentKind, str]:
        """The kind and name that a newer document of the project replaces. There is one environment,
        whatever its name."""
        is_single = self.kind in (DocumentKind.ENVIRONMENT, DocumentKind.LOW_LEVEL)
        return (self.kind, "" if is_single else self.name)


def check_name(name: Text, what: str, findings: Findings) -> bool:
    """Returns whether a name can stand in C++ and Python; adds an error where it cannot.

    What has such a name is read all the same: code that uses the name is not wrong as well.
    """
    if not _IDENTIFIER.fullmatch(name.text):
        hint = (
            "A name is at most 64 letters (A-Z, a-z), digits and underscores, and does not start with a digit"
        )
    elif name.text in SPECIAL_NAMES or name.text == "__input" or COMPILER_NAMES.fullmatch(name.text):
        hint = "It means something else already; choose another name"
    else:
        return True
    findings.error("AOS126", f"{name.text!r} cannot be the name of {what}", name.span, hint)
    return False


def enum_type(name: Text, values: Iterable[Text], findings: Findings) -> EnumType:
    """The enum of these values; an error for each that cannot be a name."""
    values = tuple(_unnumbered(value, findings) for value in values if value.text)
    texts, spans = tuple(value.text for value in values), tuple(value.span for value in values)
    return EnumType(name.text, texts, name.span, spans)


def _unnumbered(value: Text, findings: Findings) -> Text:
    """Returns the value's name; an error where it cannot be one, or has a number of its own."""
    name, equals, number = value.text.partition("=")
    if equals and _IDENTIFIER.fullmatch(name.strip()):
        message = f"the enum value {name.strip()} cannot have a number of its own"
        findings.error("AOS126", message, value.span, f"Values count from 0: leave out `={number}`")
        return Text(name.strip(), value.span)
    check_name(value, "an enum value", findings)
    return value


def array_type(type_name: str) -> tuple[str, bool, str]:
    """Splits `T[E]`, `T[]` or `T`: the element's type, whether it is an array, and the enum that indexes
    it."""
    match = _ARRAY.fullmatch(type_name)
    return (match[1], True, match[2]) if match is not None else (type_name, False, "")


def normal_type(name: Text, findings: Findings) -> str:
    """The type's canonical spelling; a warning where it is another."""
    canonical = _TYPE_SPELLINGS.get(name.text)
    if canonical is None:
        return name.text
    findings.warning("AOS127", f"the type {name.text}", name.span, f"It is read as {canonical}")
    return canonical


def check_penalty(skill: str, penalty: float, span: Span, findings: Findings) -> None:
    """Warns of a penalty above 0, at its number."""
    if penalty > 0:
        message = f"{skill} earns {penalty:g} where its precondition does not hold"
        findings.warning("AOS147", message, span, f"A penalty is added to the reward: write -{penalty:g}")


_VERSION = re.compile(r"\d{1,9}(\.\d{1,9}){0,3}")


def read_version(value: Text | None, findings: Findings) -> Text | None:
    """One to four numbers joined by dots; None, with a warning, for anything else that is there."""
    if value is None or not value.text:
        return None
    if not _VERSION.fullmatch(value.text):
        hint = "It is not compared; write one to four numbers joined by dots, such as 1.2.0"
        findings.warning("AOS106", f"{value.text!r} is no version", value.span, hint)
        return None
    return value


def is_higher(version: str, other: str) -> bool:
    """Number by number; numbers that are not given are 0."""
    return _numbers(version) > _numbers(other)


def _numbers(version: str) -> list[int]:
    numbers = [int(number) for number in version.split(".")]
    return numbers + [0] * (4 - len(numbers))
