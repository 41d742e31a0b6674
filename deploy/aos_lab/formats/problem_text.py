"""The text of a problem file: where its words stand, and what is wrong with them."""

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from typing import Protocol, TypeVar

import msgspec

from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.errors import DocumentError
from aos_protocol.spelling import did_you_mean

M = TypeVar("M")

_WORD = re.compile(r"\S+")
_MAX_FINDINGS = 50
_EXCERPT_LENGTH = 200
_MAX_DIGITS = 18
_COMPARED = 1000
"""So many names are compared with an unknown one."""


class Placed(Protocol):
    """A thing at a line and a column of the file; both count from 1."""

    @property
    def line(self) -> int: ...

    @property
    def column(self) -> int: ...


class TooManyFindingsError(Exception):
    """There is no point in reading on."""


class Word(msgspec.Struct, frozen=True, gc=False):
    """A word of the file and its place; lines and columns count from 1."""

    text: str
    line: int
    column: int

    @property
    def count(self) -> int | None:
        """The whole number that the word is; None for another word. One with too many digits is 10^18."""
        if not self.text.isdecimal():
            return None
        return int(self.text) if len(self.text) <= _MAX_DIGITS else 10**_MAX_DIGITS


def words_of(text: str, line: int = 1, column: int = 1) -> Iterator[Word]:
    """The words between blanks of a text that begins at this place."""
    for offset, part in enumerate(text.split("\n")):
        before = column if offset == 0 else 1
        for match in _WORD.finditer(part):
            yield Word(match.group(), line + offset, before + match.start())


def advice_on_number(text: str) -> str:
    """Advice on a word that should be a number and has a comma; empty for others."""
    if text.endswith(","):
        return "Numbers stand between blanks"
    return "A decimal is written with a point" if "," in text else ""


class ProblemFindings:
    """Collects the mistakes of one file, so that all of them are told in one run."""

    def __init__(self, name: str, text: str) -> None:
        self._name = name
        self._lines = text.split("\n")
        self._found: list[Diagnostic] = []

    def error(self, code: str, message: str, at: Placed, hint: str = "") -> None:
        """Raises TooManyFindingsError where the file seems to be something else."""
        excerpt = self._lines[at.line - 1] if 0 < at.line <= len(self._lines) else ""
        excerpt = excerpt[: at.column + _EXCERPT_LENGTH].rstrip()
        span = Span(self._name, at.line, at.column)
        self._found.append(Diagnostic(Severity.ERROR, code, message, span, hint, excerpt))
        if len(self._found) >= _MAX_FINDINGS:
            raise TooManyFindingsError

    def unknown(self, kind: str, word: Word, known: Iterable[str], keywords: tuple[str, ...] = ()) -> None:
        """A name that nothing has, where these keywords may stand, too."""
        names = [name for name in known if name]
        shown = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")
        hint = did_you_mean(word.text, (*keywords, *names[:_COMPARED])) or f"There is: {shown}"
        self.error("AOS110", f"there is no {kind} {word.text}", word, hint)

    @property
    def has_any(self) -> bool:
        return bool(self._found)

    def model_of(self, read: Callable[[], M | None]) -> M:
        """Reads the file's model; DocumentError with everything found, or where there is no model."""
        model = None
        with suppress(TooManyFindingsError):
            model = read()
        if self._found:
            found = tuple(sorted(self._found, key=lambda finding: finding.span))
            message, hint = f"{self._name} has mistakes", "Mend the places named above"
            raise DocumentError(message, code=found[0].code, hint=hint, diagnostics=found)
        if model is None:
            raise DocumentError(f"{self._name} holds no model", code="AOS107")
        return model
