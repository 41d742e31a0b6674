"""A file's text with its places."""

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
