"""Findings about a user's document: where, which code, what is wrong, and what to do.

A diagnostic is collected, never raised: one run over a bundle reports all of them. Machine faults are
exceptions and live in `errors`.
"""

from collections.abc import Iterable

import msgspec

from aos_protocol.older_python import StrEnum
from aos_protocol.spelling import printable

_EXCERPT_WIDTH = 100


class Severity(StrEnum):
    """The weight of a finding: an error keeps a bundle out of the catalogue, a warning does not."""

    ERROR = "error"
    WARNING = "warning"
    REMARK = "remark"


class Span(msgspec.Struct, frozen=True, order=True):
    """A place in a document. `file` is relative to the bundle; line and column count from 1, 0 is unknown."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        parts = [self.file, *(str(n) for n in (self.line, self.column) if n)]
        return ":".join(parts)


class Mend(msgspec.Struct, frozen=True):
    """An edit that an editor may offer: at `span`, `length` characters of the line become `text`."""

    span: Span
    length: int
    text: str


class Diagnostic(msgspec.Struct, frozen=True):
    """One finding. `code` is `AOS` and three digits, see `errors`; `hint` says what to do about it.

    `mend` does what the hint says, where that is one edit.
    """

    severity: Severity
    code: str
    message: str
    span: Span
    hint: str = ""
    excerpt: str = ""
    mend: Mend | None = None

    @property
    def is_error(self) -> bool:
        return self.severity is Severity.ERROR


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Returns whether any of them is an error."""
    return any(diagnostic.is_error for diagnostic in diagnostics)


def render(diagnostic: Diagnostic) -> str:
    """The text form: `file:line:col: error[AOS123]: what. hint`, then the source line and a caret."""
    head = f"{diagnostic.span}: {diagnostic.severity}[{diagnostic.code}]: {diagnostic.message}"
    if diagnostic.hint:
        head = f"{head}{'' if head.endswith('.') else '.'} {diagnostic.hint}"
    head = printable(head)
    if not diagnostic.excerpt:
        return head
    number = str(diagnostic.span.line)
    excerpt, column = _window(diagnostic.excerpt, diagnostic.span.column)
    shown = "".join(character if _is_shown(character) else "\ufffd" for character in excerpt)
    lines = [head, f"  {number} | {shown}"]
    if column:
        padding = "".join("\t" if character == "\t" else " " for character in excerpt[: column - 1])
        lines.append(f"  {' ' * len(number)} | {padding}^")
    return "\n".join(lines)


def _is_shown(character: str) -> bool:
    return character.isprintable() or character == "\t"


def _window(excerpt: str, column: int) -> tuple[str, int]:
    """The part of a long line around a column, and the column in it."""
    if len(excerpt) <= _EXCERPT_WIDTH:
        return excerpt, column
    start = max(0, min(column - _EXCERPT_WIDTH // 2, len(excerpt) - _EXCERPT_WIDTH))
    end = start + _EXCERPT_WIDTH
    before, after = "…" if start else "", "…" if end < len(excerpt) else ""
    shift = start - len(before)
    return f"{before}{excerpt[start:end]}{after}", max(0, column - shift)
