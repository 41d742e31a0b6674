"""Documents from one dialect into another, with proof: what was written is read again and compared."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import msgspec

from aos_language.findings import Findings
from aos_language.reading.document import Document, DocumentKind
from aos_language.reading.files import read_documents
from aos_language.writing.json_writer import json_text
from aos_language.writing.sdl_writer import sdl_text
from aos_protocol.diagnostics import Diagnostic, Span
from aos_protocol.documents import Snippet

_SUFFIXES = {
    DocumentKind.ENVIRONMENT: ".ef",
    DocumentKind.SKILL: ".sd",
    DocumentKind.MAPPING: ".am",
    DocumentKind.LOW_LEVEL: ".lf",
}
_NOT_COMPARED = frozenset(
    {
        "span",
        "index_span",
        "low_level_span",
        "type_span",
        "value_spans",
        "source_span",
        "response_variable_span",
    }
)


class Dialect(StrEnum):
    SDL = "sdl"
    JSON = "json"


def convert(files: Mapping[str, bytes], dialect: Dialect) -> tuple[dict[str, str], tuple[Diagnostic, ...]]:
    """All documents of a bundle in one dialect, by file name, and what was found on the way.

    With an error among the findings there are no files: a document that cannot be read, two that would get
    one name, or AOS130 for a document that the dialect cannot say exactly.
    """
    findings = Findings()
    texts: dict[str, str] = {}
    for source, document in read_documents(files, findings).items():
        if document.content is None:
            continue
        name = _file_name(document, dialect)
        if name in texts:
            findings.error("AOS111", f"a second {document.kind.value}", document.span)
        version = document.version.text if document.version is not None else ""
        write = sdl_text if dialect is Dialect.SDL else json_text
        texts[name] = write(document.content, version)
        if not findings.has_errors:
            _prove(document, source, name, texts[name], findings)
    return ({} if findings.has_errors else texts), findings.sorted()


def _file_name(document: Document, dialect: Dialect) -> str:
    is_skill = document.kind in (DocumentKind.SKILL, DocumentKind.MAPPING)
    stem = document.name if is_skill else "environment"
    return stem + _SUFFIXES[document.kind] + (".json" if dialect is Dialect.JSON else "")


def _prove(document: Document, source: str, name: str, text: str, findings: Findings) -> None:
    again = Findings()
    read = read_documents({name: text.encode()}, again).get(name)
    expected = without_origins(document.content)
    found = without_origins(read.content) if read is not None else None
    if expected == found and not again.has_errors:
        return
    path = _difference(expected, found)
    message = f"{name} could not say the same at {path}" if path else f"{name} could not be read again"
    hint = "Keep this document as it is, or write that place more plainly"
    findings.error("AOS130", message, Span(source), hint)


def without_origins(value: Any) -> Any:
    """A document, or a part of it, as plain values without places; what always holds is `True`."""
    if isinstance(value, Snippet):
        return value.code
    if isinstance(value, tuple):
        return [without_origins(item) for item in value]
    if not isinstance(value, msgspec.Struct):
        return value
    plain = {
        field: without_origins(getattr(value, field))
        for field in value.__struct_fields__
        if field not in _NOT_COMPARED
    }
    if "condition" in plain and "response" in plain:
        plain["condition"] = plain["condition"] or "True"
    return plain


def _difference(one: Any, other: Any) -> str:
    """The path to the first place where two plain values differ."""
    if isinstance(one, dict) and isinstance(other, dict):
        key = next((key for key in one if one[key] != other.get(key)), "")
        inner = _difference(one[key], other.get(key)) if key else ""
        return f"{key}.{inner}" if inner else key
    if isinstance(one, list) and isinstance(other, list):
        pairs = enumerate(zip(one, other, strict=False))
        index = next((i for i, (left, right) in pairs if left != right), None)
        return "" if index is None else f"{index}.{_difference(one[index], other[index])}".rstrip(".")
    return ""
