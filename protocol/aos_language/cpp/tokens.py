"""C++ text cut into comments, literals and brackets: what decides whether a snippet stays in its function.

A parser recovers from an unbalanced bracket somewhere; a person wants to know which one. Line continuations,
digraphs, raw strings and digit separators are read as the compiler reads them, so that no bracket hides.
"""

import re
import unicodedata
from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import NamedTuple

import msgspec

MAX_NESTING = 200

_TOKEN = re.compile(
    r"""
      (?P<raw>(?:u8|[uUL])?R"(?P<delimiter>[^()\\\s"]{0,16})\()
    | (?P<string>(?:u8|[uUL])?"(?:[^"\\\n]|\\.)*")
    | (?P<char>(?:u8|[uUL])?'(?:[^'\\\n]|\\.)+')
    | (?P<line_comment>//(?:\\[ \t\r\f\v]*\n|[^\n])*)
    | (?P<block_comment>/\*.*?\*/)
    | (?P<open_comment>/\*)
    | (?P<number>\.?[0-9](?:'?[A-Za-z0-9_.])*)
    | (?P<word>[A-Za-z_]\w*)
    | (?P<continuation>\\[ \t\r\f\v]*\n)
    | (?P<directive>(?<![^\n])[ \t\f\v]*(?:\#|%:)[^\n]*)
    | (?P<hash>\#[^\n]*)
    | (?P<scope><::(?![:>]))
    | (?P<list>(?<==)[ \t]*\[[^\[\](){}=&;]*\](?=[ \t]*;))
    | (?P<bracket>[()\[\]{}]|<%|%>|<:|:>)
    | (?P<quote>["'])
    | (?P<arrow>(?<![<=>!])=[<>])
    | (?P<other>.)
    """,
    re.VERBOSE | re.DOTALL,
)
_ONE_CHARACTER = re.compile(
    r"(?:u8|[uUL])?'(?:[^'\\]|\\(?:[0-7]{1,3}|x[0-9A-Fa-f]+|u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|\D))'"
)
_CANONICAL = {"<%": "{", "%>": "}", "<:": "[", ":>": "]"}
_PARTNER = {")": "(", "]": "[", "}": "{"}
_BEFORE_STATEMENT = frozenset({"", ";", "{", "}", ":", "do", "else", "try"})
_DIRECTIVES = frozenset({
    "define", "elif", "else", "endif", "error", "if", "ifdef", "ifndef", "import", "include", "line",
    "pragma", "undef", "warning",
})  # fmt: skip
_CLOSES = {opening: closing for closing, opening in _PARTNER.items()}


class Extent(NamedTuple):
    """A piece of a code text: `code[start:end]`."""

    start: int
    end: int


_IN_PLACE_OF = {
    "include": "The standard library's algorithms, containers and mathematics are there without it",
    "define": "Write `const int NAME = 4;`: constants and functions are `shared_code:` of the environment",
}
"""Directives that people write, with what there is in their place."""

_FROM_A_PAGE = {
    **dict.fromkeys("\u00a0\u2002\u2003\u2007\u2009\u200b\u200c\u200d\u202f\u2028\u2060\u3000\ufeff", " "),
    **dict.fromkeys("\u201c\u201d\u201e\u00ab\u00bb", '"'),
    **dict.fromkeys("\u2018\u2019\u2032", "'"),
    **dict.fromkeys("\u2010\u2011\u2013\u2014\u2212", "-"),
    "\u00d7": "*",
    "\u00f7": "/",
    "\u2260": "!=",
    "\u2264": "<=",
    "\u2265": ">=",
}
"""Characters of pages and word processors, with what C++ has in their place."""

_PYTHON_LINE = re.compile(
    r"^[ \t]*(?P<word>if|elif|else|for|while|def)\b(?P<head>[^;{}?\n]*):[ \t]*(?://.*|#.*)?$", re.MULTILINE
)


class FaultKind(StrEnum):
    """The reasons why a snippet cannot be placed in a function. SYNTAX is a hint, the compiler decides."""

    BRACKET = "bracket"
    QUOTE = "quote"
    COMMENT = "comment"
    PREPROCESSOR = "preprocessor"
    SIZE = "size"
    PYTHON = "python"
    CHARACTER = "character"
    SYNTAX = "syntax"


class Fault(msgspec.Struct, frozen=True):
    """One reason, with its place."""

    kind: FaultKind
    message: str
    extent: Extent
    hint: str = ""
    instead: str = ""
    """The text that mends it in place of the first character, where there is one."""


class Tokens(msgspec.Struct, frozen=True):
    """The comments, the string and character literals, and what is wrong.

    `missing_semicolons` are the offsets where statements end without one: before the brace that closes their
    block, and at the end of the code.
    """

    comments: tuple[Extent, ...]
    literals: tuple[Extent, ...]
    faults: tuple[Fault, ...]
    missing_semicolons: tuple[int, ...]


def cut(code: str) -> Tokens:
    """The tokens of a snippet; every fault of it, in text order."""
    comments: list[Extent] = []
    literals: list[Extent] = []
    faults: list[Fault] = []
    brackets = _Brackets()
    statements = _Statements()
    position = 0
    while match := _TOKEN.match(code, position):
        position = match.end()
        kind = str(match.lastgroup)
        if "comment" not in kind and not match.group().isspace():
            statements.take(match.group(), match.end())
        if kind in ("word", "number", "scope") or (kind == "other" and match.group() not in _FROM_A_PAGE):
            continue
        extent = Extent(*match.span())
        if kind == "raw":
            closing = f'){match["delimiter"]}"'
            end = code.find(closing, position)
            if end < 0:
                faults.append(Fault(FaultKind.QUOTE, "this raw string is never closed", extent))
                break
            position = end + len(closing)
            extent = Extent(match.start(), position)
        if kind in ("raw", "string", "char"):
            literals.append(extent)
            if kind == "char" and _ONE_CHARACTER.fullmatch(match.group()) is None:
                hint = "A text stands in double quotes"
                faults.append(Fault(FaultKind.QUOTE, f"{match.group()} is no character", extent, hint))
        elif kind in ("line_comment", "block_comment"):
            comments.append(extent)
        elif kind == "bracket":
            faults += brackets.take(match.group(), extent)
        elif kind == "directive":
            start = match.end() - len(match.group().lstrip())
            faults.append(_directive(match.group(), Extent(start, match.end())))
        elif kind == "hash":
            faults.append(_no_comment(extent))
        elif kind == "arrow":
            message, hint = f"`{match.group()}` is no operator of C++", f"Write `{match.group()[::-1]}`"
            faults.append(Fault(FaultKind.CHARACTER, message, extent, hint))
        elif kind == "list":
            faults.append(_list_of_python(Extent(code.index("[", match.start()), match.end()), code))
        elif kind == "other":
            faults.append(_from_a_page(match.group(), extent))
        elif kind == "continuation":
            faults.append(Fault(FaultKind.PREPROCESSOR, "a backslash at the end of a line", extent))
        elif kind == "open_comment":
            faults.append(Fault(FaultKind.COMMENT, "this comment is never closed", extent))
            position = len(code)
        else:
            faults.append(Fault(FaultKind.QUOTE, f"this {match.group()} has no partner on its line", extent))
            position = _end_of_line(code, position)
    faults += brackets.still_open()
    faults += _python_lines(code, (*comments, *literals))
    faults.sort(key=lambda fault: fault.extent.start)
    return Tokens(tuple(comments), tuple(literals), tuple(faults), statements.missing_semicolons())


class _Brackets:
    """The brackets that are open, and the complaint for each that does not fit."""

    def __init__(self) -> None:
        self._open: list[tuple[str, Extent]] = []

    def take(self, spelling: str, extent: Extent) -> list[Fault]:
        bracket = _CANONICAL.get(spelling, spelling)
        if bracket in _CLOSES:
            self._open.append((bracket, extent))
            if len(self._open) == MAX_NESTING + 1:
                return [Fault(FaultKind.BRACKET, f"brackets nested deeper than {MAX_NESTING}", extent)]
            return []
        if not self._open:
            return [Fault(FaultKind.BRACKET, f"this {spelling} closes nothing", extent)]
        opening, _ = self._open[-1]
        if opening == _PARTNER[bracket]:
            self._open.pop()
            return []
        if any(other == _PARTNER[bracket] for other, _ in self._open):
            faults = self._drop_to(_PARTNER[bracket])
            self._open.pop()
            return faults
        return [Fault(FaultKind.BRACKET, f"this {spelling} does not fit the {opening} before it", extent)]

    def still_open(self) -> list[Fault]:
        return [_never_closed(opening, extent) for opening, extent in self._open]

    def _drop_to(self, opening: str) -> list[Fault]:
        faults = []
        while self._open[-1][0] != opening:
            faults.append(_never_closed(*self._open.pop()))
        return faults


class _Statements:
    """The ends of statements, and whether a semicolon is there.

    A brace opens a block where a statement may begin and after a closing parenthesis; every other brace is of
    a list, an enum or the like, and what it closes needs a semicolon too.
    """

    def __init__(self) -> None:
        self._is_block: list[bool] = []
        self._previous = ""
        self._end = 0
        self._missing: list[int] = []

    def take(self, token: str, end: int) -> None:
        token = _CANONICAL.get(token, token)
        if token in _CLOSES:
            self._is_block.append(token == "{" and self._begins_block())
        elif token in _PARTNER and self._is_block:
            is_block = self._is_block.pop()
            if is_block:
                self._require_semicolon()
            elif token == "}":
                token = "list}"
        self._previous, self._end = token, end

    def missing_semicolons(self) -> tuple[int, ...]:
        """Returns the places where a semicolon is missing; it is called after the last token."""
        if not self._is_block:
            self._require_semicolon()
        return tuple(self._missing)

    def _begins_block(self) -> bool:
        is_among_statements = not self._is_block or self._is_block[-1]
        return self._previous == ")" or (is_among_statements and self._previous in _BEFORE_STATEMENT)

    def _require_semicolon(self) -> None:
        if self._previous not in _BEFORE_STATEMENT:
            self._missing.append(self._end)


def _never_closed(opening: str, extent: Extent) -> Fault:
    return Fault(FaultKind.BRACKET, f"this {opening} is never closed by {_CLOSES[opening]}", extent)


def _directive(text: str, extent: Extent) -> Fault:
    words = text.strip().removeprefix("%:").removeprefix("#").split(maxsplit=1)
    if text.lstrip().startswith("#") and words and words[0] not in _DIRECTIVES:
        return _no_comment(extent)
    name = words[0] if words else ""
    return Fault(FaultKind.PREPROCESSOR, f"a preprocessor line (#{name})", extent, _IN_PLACE_OF.get(name, ""))


def _no_comment(extent: Extent) -> Fault:
    message = "`#` does not begin a comment in C++"
    return Fault(FaultKind.PREPROCESSOR, message, extent, "Write `//` instead", "//")


def _list_of_python(extent: Extent, code: str) -> Fault:
    hint = f"Write `{{{code[extent.start + 1 : extent.end - 1]}}}`"
    return Fault(FaultKind.CHARACTER, "a list stands in braces in C++", extent, hint)


def _from_a_page(character: str, extent: Extent) -> Fault:
    instead = _FROM_A_PAGE[character]
    name = unicodedata.name(character, f"U+{ord(character):04X}").lower()
    hint = "Write a plain space" if instead == " " else f"Write `{instead}`"
    return Fault(FaultKind.CHARACTER, f"a {name} is no character of C++", extent, hint, instead)


def _python_lines(code: str, elsewhere: Sequence[Extent]) -> Iterator[Fault]:
    """The first line with a statement of Python that C++ does not have."""
    for match in _PYTHON_LINE.finditer(code):
        extent = Extent(*match.span("word"))
        is_text = any(part.start <= extent.start < part.end for part in elsewhere)
        if not is_text and match["head"].count("(") == match["head"].count(")"):
            hint = "The model's code is C++: `if (...) { ... } else { ... }`"
            yield Fault(FaultKind.PYTHON, f"`{match['word']} ...:` is Python", extent, hint)
            return


def _end_of_line(code: str, position: int) -> int:
    newline = code.find("\n", position)
    return len(code) if newline < 0 else newline
