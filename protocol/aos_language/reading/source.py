"""A file's text with its places, and snippets of it cut to size."""

from __future__ import annotations

import re
from bisect import bisect_right

import msgspec

from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Snippet

MAX_FILE_BYTES = 1024 * 1024

_BYTE_ORDER_MARK = "\ufeff"
_UTF_16_MARKS = (b"\xff\xfe", b"\xfe\xff")


class Source:
    """The text of one file, newlines as `\\n`, without a byte order mark."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text
        self.lines = text.split("\n")
        self._starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def span(self, offset: int = 0) -> Span:
        """The place of a character of the text."""
        line = bisect_right(self._starts, offset)
        return Span(self.name, line, offset - self._starts[line - 1] + 1)

    def line(self, number: int) -> str:
        """A line, from 1; empty outside the text."""
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""


class Text(msgspec.Struct, frozen=True):
    """A piece of one line of a source, with its place."""

    text: str
    span: Span

    def strip(self) -> Text:
        """Returns the text without the blanks around it; the place moves along."""
        before = len(self.text) - len(self.text.lstrip())
        span = Span(self.span.file, self.span.line, self.span.column + before)
        return Text(self.text.strip(), span)

    def after(self, offset: int) -> Text:
        """Returns the text behind the first `offset` characters."""
        return Text(self.text[offset:], Span(self.span.file, self.span.line, self.span.column + offset))

    def snippet(self) -> Snippet:
        return Snippet(self.text, (self.span,))


def open_source(name: str, data: bytes, findings: Findings) -> Source | None:
    """The text of a file; None, with a finding, where it is no text.

    A byte order mark and carriage returns are taken away; editors do not count them either.
    """
    start = Span(name)
    if len(data) > MAX_FILE_BYTES:
        findings.error("AOS120", f"{len(data)} bytes are too many for a document", start)
        return None
    if data.startswith(_UTF_16_MARKS):
        findings.error("AOS101", "this is UTF-16 text", start, "Save it as UTF-8")
        return None
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        column = len(data[: error.start].rpartition(b"\n")[2].decode("utf-8")) + 1
        findings.error("AOS101", "this is not UTF-8 text", Span(name, line, column), "Save it as UTF-8")
        return None
    has_mark = text.startswith(_BYTE_ORDER_MARK)
    text = text.removeprefix(_BYTE_ORDER_MARK).replace("\r\n", "\n").replace("\r", "\n")
    source = Source(name, text)
    if "\0" in text:
        findings.error("AOS101", "this file holds NUL characters", source.span(text.index("\0")))
        return None
    findings.add_source(name, source.lines)
    if has_mark:
        findings.warning("AOS127", "a byte order mark at the start", source.span(), "It is skipped")
    return source


def cut(snippet: Snippet, start: int, end: int) -> Snippet:
    """The part between two character offsets; at least an empty one at `start`."""
    before = snippet.code[:start]
    line = before.count("\n") + 1
    column = start - (before.rfind("\n") + 1) + 1
    code = snippet.code[start:end]
    last = line + code.count("\n")
    origins = (snippet.locate(line, column), *snippet.origins[line:last])
    escapes = []
    for at, index, width in snippet.escapes:
        shift = column - 1 if at == line else 0
        if line <= at <= last and index > shift:
            escapes.append((at - line + 1, index - shift, width))
    return Snippet(code, origins, tuple(escapes))


def expression(snippet: Snippet, *, drop_semicolon: bool = False) -> Snippet:
    """Returns the snippet without the blanks around it, and without a final semicolon if that is to be
    dropped."""
    code = snippet.code.rstrip()
    while drop_semicolon and code.endswith(";"):
        code = code[:-1].rstrip()
    start = len(code) - len(code.lstrip())
    return cut(snippet, start, len(code))


def guarded(condition: Snippet, code: Snippet) -> Snippet:
    """C++ statements that run only where a condition holds."""
    shift = len(condition.origins)
    escapes = [(line + 1, index, width) for line, index, width in condition.escapes]
    escapes += [(line + shift + 2, index, width) for line, index, width in code.escapes]
    origins = (condition.span, *condition.origins, code.span, *code.origins, code.span)
    return Snippet(f"if (\n{condition.code}\n) {{\n{code.code}\n}}", origins, tuple(escapes))


def joined(first: Snippet, second: Snippet) -> Snippet:
    """Returns both, the second one below the first."""
    shift = len(first.origins)
    escapes = [(line + shift, index, width) for line, index, width in second.escapes]
    code = f"{first.code}\n{second.code}"
    return Snippet(code, (*first.origins, *second.origins), (*first.escapes, *escapes))


def without_blank_lines(snippet: Snippet) -> Snippet:
    """Returns the snippet without blank lines at the start and blanks at the end."""
    code = snippet.code.rstrip()
    lead = len(code) - len(code.lstrip())
    return cut(snippet, code.rfind("\n", 0, lead) + 1, len(code))


def dedented(snippet: Snippet) -> Snippet:
    """Returns the snippet without the indentation that all of its lines of code share, as Python wants it."""
    lines = snippet.code.split("\n")
    indents = [line[: len(line) - len(line.lstrip(" \t"))] for line in lines]
    of_code = [indent for indent, line in zip(indents, lines, strict=True) if _is_code(line)]
    common = of_code[0] if of_code else ""
    for indent in of_code:
        while not indent.startswith(common):
            common = common[:-1]
    if not common:
        return snippet
    widths = [min(len(indent), len(common)) for indent in indents]
    cut_lines = [line[width:] if line.strip() else "" for line, width in zip(lines, widths, strict=True)]
    origins = tuple(snippet.locate(number, width + 1) for number, width in enumerate(widths, 1))
    escapes = [(at, index - widths[at - 1], size) for at, index, size in snippet.escapes]
    return Snippet("\n".join(cut_lines), origins, tuple(escape for escape in escapes if escape[1] > 0))


def _is_code(line: str) -> bool:
    """Returns whether a line of Python says anything; comments may be indented as they like."""
    return not line.lstrip(" \t").startswith("#") and not line.isspace() and line != ""
