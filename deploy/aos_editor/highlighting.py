"""The kind of each word of an SDL file, for colours: of the grammar, C++, Python, and the bundle's names."""

import keyword
import re
from collections.abc import Iterable, Iterator
from pathlib import PurePath

import msgspec

from aos_editor.documents import BUILT_INS
from aos_editor.symbols import Occurrence, SymbolKind
from aos_language.cpp.keywords import CPP_KEYWORDS, SPECIAL_NAMES
from aos_language.findings import Findings
from aos_language.reading.sdl_text import Body, Part, parse_sdl
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import Source, Text

_KINDS = {
    SymbolKind.VARIABLE: "variable",
    SymbolKind.VALUE: "enumMember",
    SymbolKind.TYPE: "type",
    SymbolKind.FIELD: "property",
    SymbolKind.PARAMETER: "parameter",
    SymbolKind.RESPONSE: "enumMember",
    SymbolKind.LOCAL: "variable",
    SymbolKind.SKILL: "class",
}
TOKEN_KINDS = (
    "class", "comment", "enumMember", "function", "keyword", "macro", "number", "parameter", "property",
    "string", "type", "variable",
)  # fmt: skip
"""The names of the protocol for kinds of tokens, in the order of their numbers."""

_STRING = r"\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'"
_REST = r"(?P<number>\b\d[\w.]*)|(?P<word>[A-Za-z_]\w*)"
_LEXERS = {
    Body.CPP: re.compile(rf"(?P<comment>//.*|/\*.*?(?:\*/|$))|(?P<string>{_STRING})|{_REST}"),
    Body.PYTHON: re.compile(rf"(?P<comment>\#.*)|(?P<string>{_STRING})|{_REST}"),
}
_KEYWORDS = {Body.CPP: CPP_KEYWORDS, Body.PYTHON: frozenset(keyword.kwlist)}


class Token(msgspec.Struct, frozen=True, order=True):
    """A word; line from 1, column from 0, in characters."""

    line: int
    column: int
    length: int
    kind: str


def tokens_of(name: str, text: str, occurrences: Iterable[Occurrence]) -> list[Token]:
    """The tokens of an SDL file in order; `occurrences` are the bundle's names in it."""
    suffix = PurePath(name).suffix.lower()
    if suffix not in GRAMMARS:
        return []
    tokens = {
        (occurrence.span.line, occurrence.span.column - 1): _KINDS[occurrence.symbol.kind]
        for occurrence in occurrences
        if occurrence.symbol.kind is not SymbolKind.SKILL or not occurrence.is_declaration
    }
    lengths = {
        (occurrence.span.line, occurrence.span.column - 1): len(occurrence.symbol.name)
        for occurrence in occurrences
    }
    found = {place: Token(*place, lengths[place], kind) for place, kind in tokens.items()}
    for section in parse_sdl(Source(name, text), GRAMMARS[suffix], {}, Findings()):
        for part in (section, *section.parts):
            for token in _of_part(part):
                found.setdefault((token.line, token.column), token)
    return sorted(found.values())


def _of_part(part: Part) -> Iterator[Token]:
    yield Token(part.span.line, part.span.column - 1, len(part.word), "keyword")
    if part.body is not Body.NONE:
        for line in (part.value, *part.lines):
            yield from _of_code(line, part.body)


def _of_code(line: Text, body: Body) -> Iterator[Token]:
    for match in _LEXERS[body].finditer(line.text):
        kind = match.lastgroup or ""
        if kind == "word":
            kind = _kind_of_word(match.group(), line.text[match.end() :], body)
        if kind:
            column = line.span.column - 1 + match.start()
            yield Token(line.span.line, column, len(match.group()), kind)


def _kind_of_word(word: str, after: str, body: Body) -> str:
    if word in _KEYWORDS[body]:
        return "keyword"
    if word in SPECIAL_NAMES or word in BUILT_INS or word in ("AOS", "AOSUtils", "__input"):
        return "macro"
    return "function" if after.lstrip().startswith("(") else ""
