"""Findings as SARIF 2.1.0, the form that code hosts and editors read (OASIS, 2020)."""

from collections.abc import Iterable
from typing import Any

from aos_protocol.diagnostics import Diagnostic, Mend, Severity, Span
from aos_protocol.errors import CODES

_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.REMARK: "note"}


def sarif_log(diagnostics: Iterable[Diagnostic], *, folder: str, version: str) -> dict[str, Any]:
    """One run of the tool `aos lint`. `folder` leads to the files of the diagnostics, `version` is its own.

    Only the rules that were found are listed, with their meaning from the table of codes.
    """
    diagnostics = tuple(diagnostics)
    codes = sorted({diagnostic.code for diagnostic in diagnostics})
    rules = [{"id": code, "shortDescription": {"text": CODES.get(code, code)}} for code in codes]
    results = [_result(diagnostic, codes.index(diagnostic.code), folder) for diagnostic in diagnostics]
    driver = {"name": "aos lint", "version": version, "rules": rules}
    return {
        "$schema": _SCHEMA,
        "version": "2.1.0",
        # Columns of documents count characters.
        "runs": [{"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}],
    }


def _result(diagnostic: Diagnostic, rule: int, folder: str) -> dict[str, Any]:
    text = diagnostic.message
    if diagnostic.hint:
        text = f"{text.rstrip('.')}. {diagnostic.hint}"
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": rule,
        "level": _LEVELS[diagnostic.severity],
        "message": {"text": text},
        "locations": [{"physicalLocation": _location(diagnostic, folder)}],
    }
    if diagnostic.mend is not None:
        result["fixes"] = [_fix(diagnostic.hint, diagnostic.mend, folder)]
    return result


def _fix(hint: str, mend: Mend, folder: str) -> dict[str, Any]:
    span = mend.span
    region = {"startLine": span.line, "startColumn": span.column, "endColumn": span.column + mend.length}
    replacement = {"deletedRegion": region, "insertedContent": {"text": mend.text}}
    change = {"artifactLocation": _artifact(span, folder), "replacements": [replacement]}
    return {"description": {"text": hint}, "artifactChanges": [change]}


def _artifact(span: Span, folder: str) -> dict[str, str]:
    return {"uri": f"{folder.rstrip('/')}/{span.file}".replace(" ", "%20")}


def _location(diagnostic: Diagnostic, folder: str) -> dict[str, Any]:
    span = diagnostic.span
    location: dict[str, Any] = {"artifactLocation": _artifact(span, folder)}
    if span.line:
        region: dict[str, Any] = {"startLine": span.line}
        if span.column:
            region["startColumn"] = span.column
        if diagnostic.excerpt:
            region["snippet"] = {"text": diagnostic.excerpt}
        location["region"] = region
    return location
