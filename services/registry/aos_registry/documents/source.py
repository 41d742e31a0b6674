"""A file's text with its places, and the findings about it."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable

import msgspec

from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Snippet

__all__ = [
    "MAX_FILE_BYTES",
    "Findings",
    "Source",
    "Text",
    "did_you_mean",
    "nearest",
    "open_source",
    "quoted",
]

MAX_FILE_BYTES = 1024 * 1024

_LONGEST_EXCERPT = 4000
_EXCERPT_MARGIN = 200

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
        """Without the blanks around it; the place moves along."""
        before = len(self.text) - len(self.text.lstrip())
        span = Span(self.span.file, self.span.line, self.span.column + before)
        return Text(self.text.strip(), span)

    def after(self, offset: int) -> Text:
        """What follows the first `offset` characters."""
        return Text(self.text[offset:], Span(self.span.file, self.span.line, self.span.column + offset))

    def words(self) -> list[Text]:
        """The words between blanks."""
        return [
            Text(match.group(), Span(self.span.file, self.span.line, self.span.column + match.start()))
            for match in re.finditer(r"\S+", self.text)
        ]

    def snippet(self) -> Snippet:
        return Snippet(self.text, (self.span,))


class Findings:
    """The diagnostics of one run, each with the source line it is about."""

    def __init__(self) -> None:
        self._diagnostics: list[Diagnostic] = []
        self._sources: dict[str, Source] = {}

    def add_source(self, source: Source) -> None:
        self._sources[source.name] = source

    def error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self._add(Severity.ERROR, code, message, span, hint)

    def warning(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self._add(Severity.WARNING, code, message, span, hint)

    def remark(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self._add(Severity.REMARK, code, message, span, hint)

    def __len__(self) -> int:
        return len(self._diagnostics)

    @property
    def has_errors(self) -> bool:
        return any(diagnostic.is_error for diagnostic in self._diagnostics)

    def add(self, diagnostic: Diagnostic) -> None:
        """A finding of somebody else, with the source line it is about where it has none."""
        excerpt = diagnostic.excerpt or self._excerpt(diagnostic.span)
        self._diagnostics.append(msgspec.structs.replace(diagnostic, excerpt=excerpt))

    def sorted(self) -> tuple[Diagnostic, ...]:
        """By file and place; what is said twice is said once."""
        unique = dict.fromkeys(self._diagnostics)
        return tuple(sorted(unique, key=lambda diagnostic: (diagnostic.span, diagnostic.code)))

    def _add(self, severity: Severity, code: str, message: str, span: Span, hint: str) -> None:
        self._diagnostics.append(Diagnostic(severity, code, message, span, hint, self._excerpt(span)))

    def _excerpt(self, span: Span) -> str:
        source = self._sources.get(span.file)
        line = source.line(span.line).rstrip() if source is not None else ""
        return line[: span.column + _EXCERPT_MARGIN] if span.column <= _LONGEST_EXCERPT else ""


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
    findings.add_source(source)
    if has_mark:
        findings.warning("AOS127", "a byte order mark at the start", source.span(), "It is skipped")
    return source


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that is most like `name`, or nothing where none is alike; letter case counts little."""
    best, best_distance = "", max(1, len(name) // 3) + 1
    for candidate in known:
        distance = _edit_distance(name.lower(), candidate.lower(), best_distance)
        if distance < best_distance:
            best, best_distance = candidate, distance
    return best


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The hint that names the nearest known name; empty where none is near."""
    close = nearest(name, known)
    return f"Did you mean `{close}`?" if close else ""


def quoted(names: Iterable[str]) -> str:
    """Names for a message, in order: `a`, `b`."""
    return ", ".join(f"`{name}`" for name in names)


def _edit_distance(a: str, b: str, limit: int) -> int:
    """Insertions, deletions, replacements and swaps of neighbours; `limit` where there are no fewer."""
    if abs(len(a) - len(b)) >= limit:
        return limit
    before: list[int] = []
    row = list(range(len(b) + 1))
    for i, left in enumerate(a, start=1):
        two_before, before, row = before, row, [i]
        for j, right in enumerate(b, start=1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (left != right))
            if i > 1 and j > 1 and left == b[j - 2] and a[i - 2] == right:
                cost = min(cost, two_before[j - 2] + 1)
            row.append(cost)
        if min(row) >= limit:
            return limit
    return min(row[-1], limit)
