"""JSON with the place of every value, and of every character inside its strings.

Trailing commas, comments and a forgotten comma do not stop the reader; what is accepted although JSON
forbids it is reported. Keys given twice are errors. The first thing that cannot be read ends the file.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from itertools import accumulate

import msgspec

from aos_language.findings import Findings
from aos_language.reading.source import Source
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Snippet

MAX_NESTING = 64

_BLANK = re.compile(r"[ \t\n]*")
_PLAIN = re.compile(r'[^"\\\n]*')
_ESCAPE = re.compile(r'\\(?:u([0-9a-fA-F]{4})|(["\\/bfnrt]))')
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?(?![\w.])")
_WORD = re.compile(r"[A-Za-z_]\w*")
_CONTROL = {"b": "\b", "f": "\f", "n": "\n", "r": "\r", "t": "\t"}
_CONSTANTS = {"true": True, "false": False, "null": None}
_PYTHON_CONSTANTS = {"True": "true", "False": "false", "None": "null"}


class JsonString(msgspec.Struct, frozen=True):
    """`text[i]` stands in the source at `offset_of(i)`.

    `escapes` holds, for each escaped character, its index and how many more characters than in `text` the
    source has up to its end.
    """

    text: str
    start: int
    escapes: tuple[tuple[int, int], ...] = ()

    def offset_of(self, index: int) -> int:
        before = bisect_left(self.escapes, (index, 0))
        return self.start + 1 + index + (self.escapes[before - 1][1] if before else 0)

    def wide_characters(self, start: int, end: int) -> list[tuple[int, int]]:
        """(index, width) of the escaped characters between two indices."""
        first, last = (bisect_left(self.escapes, (index, 0)) for index in (start, end))
        totals = [self.escapes[first - 1][1] if first else 0, *(t for _, t in self.escapes[first:last])]
        indices = (index for index, _ in self.escapes[first:last])
        return [(i, b - a + 1) for i, a, b in zip(indices, totals, totals[1:], strict=False)]


class JsonNumber(msgspec.Struct, frozen=True):
    value: int | float
    start: int


class JsonConstant(msgspec.Struct, frozen=True):
    value: bool | None
    start: int


class JsonArray(msgspec.Struct, frozen=True):
    items: tuple[JsonValue, ...]
    start: int


class JsonObject(msgspec.Struct, frozen=True):
    members: tuple[tuple[JsonString, JsonValue], ...]
    start: int

    def get(self, key: str) -> JsonValue | None:
        return next((value for name, value in self.members if name.text == key), None)


JsonValue = JsonString | JsonNumber | JsonConstant | JsonArray | JsonObject


def describe(value: JsonValue) -> str:
    """Returns the kind of a value, for messages."""
    match value:
        case JsonString():
            return "a string"
        case JsonNumber():
            return "a number"
        case JsonArray():
            return "a list"
        case JsonObject():
            return "an object"
    return {True: "true", False: "false", None: "null"}[value.value]


def parse_json(source: Source, findings: Findings) -> JsonValue | None:
    """The value of a text; None, with an error, where it cannot be read."""
    reader = _Reader(source, findings)
    try:
        value = reader.value(0)
        reader.end()
    except _Unreadable as fault:
        findings.error("AOS104", fault.message, source.span(fault.offset), fault.hint)
        return None
    return value


class _Unreadable(Exception):
    def __init__(self, message: str, offset: int, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.offset = offset
        self.hint = hint


class _Reader:
    """A recursive descent; `_at` is the offset of the next character."""

    def __init__(self, source: Source, findings: Findings) -> None:
        self._source = source
        self._text = source.text
        self._findings = findings
        self._at = 0
        self._has_comments = False
        self._crooked: int | None = None

    def value(self, depth: int) -> JsonValue:
        self._skip_blank()
        if depth > MAX_NESTING:
            raise _Unreadable(f"values nested deeper than {MAX_NESTING}", self._at)
        character = self._text[self._at : self._at + 1]
        if character == "{":
            return self._object(depth)
        if character == "[":
            return self._array(depth)
        if character == '"':
            return self._string()
        return self._number_or_constant()

    def end(self) -> None:
        self._skip_blank()
        if self._at < len(self._text):
            raise _Unreadable("text after the end of the document", self._at)

    # --- composites ---

    def _object(self, depth: int) -> JsonObject:
        start = self._at
        self._at += 1
        members: list[tuple[JsonString, JsonValue]] = []
        keys: dict[str, JsonString] = {}
        while not self._closes("}", start):
            if self._text[self._at] != '"':
                message = f"expected a key in double quotes, found {self._found()}"
                is_outside = self._text[self._at] in "{]"
                raise _Unreadable(message, self._at, self._opened(start) if is_outside else "")
            key = self._string()
            self._skip_blank()
            if self._text[self._at : self._at + 1] != ":":
                raise _Unreadable(f'expected ":" after "{key.text}", found {self._found()}', self._at)
            self._at += 1
            value = self.value(depth + 1)
            if key.text in keys:
                self._twice(key, keys[key.text])
            else:
                keys[key.text] = key
                members.append((key, value))
            self._comma("}", start)
        return JsonObject(tuple(members), start)

    def _array(self, depth: int) -> JsonArray:
        start = self._at
        self._at += 1
        items: list[JsonValue] = []
        while not self._closes("]", start):
            items.append(self.value(depth + 1))
            self._comma("]", start)
        return JsonArray(tuple(items), start)

    def _closes(self, bracket: str, start: int) -> bool:
        self._skip_blank()
        if self._at >= len(self._text):
            # Where a bracket inside was closed further to the left than it begins, that one lacks its own.
            start = self._crooked if self._crooked is not None else start
            raise _Unreadable(f'this "{self._text[start]}" is never closed', start)
        if self._text[self._at] != bracket:
            return False
        if self._crooked is None and self._indent(self._at) < self._indent(start):
            self._crooked = start
        self._at += 1
        return True

    def _comma(self, bracket: str, start: int) -> None:
        """Takes the comma after a member; one too many is a warning, a forgotten one an error."""
        end = self._at
        self._skip_blank()
        character = self._text[self._at : self._at + 1]
        if character == ",":
            comma = self._at
            self._at += 1
            self._skip_blank()
            if self._text[self._at : self._at + 1] == bracket:
                span = self._source.span(comma)
                self._findings.warning("AOS127", f'a comma before "{bracket}"', span, "It is skipped")
        elif character in ('"', "{", "[") or _NUMBER.match(self._text, self._at):
            self._findings.error("AOS104", "a comma is missing here", self._source.span(end))
        elif character and character != bracket:
            is_other = character in "}]" or character + bracket == ":]"
            hint = self._opened(start) if is_other else ""
            if self._text[end - 1] == '"' and character.isalnum():
                hint = 'A text ended before it: is a quote missing there? In a text a quote is written \\"'
            raise _Unreadable(f'expected "," or "{bracket}", found {self._found()}', self._at, hint)

    def _indent(self, at: int) -> int:
        """The number of blanks that the line of a place begins with."""
        match = _BLANK.match(self._text, self._text.rfind("\n", 0, at) + 1)
        return len(match.group()) if match else 0

    def _opened(self, start: int) -> str:
        return f'The "{self._text[start]}" on line {self._source.span(start).line} is still open'

    def _twice(self, key: JsonString, first: JsonString) -> None:
        line = self._source.span(first.start).line
        span = self._source.span(key.start)
        hint = f"The first is on line {line}; keep one of them"
        self._findings.error("AOS103", f'the key "{key.text}" is given twice', span, hint)

    # --- scalars ---

    def _string(self) -> JsonString:
        start = self._at
        self._at += 1
        parts: list[str] = []
        escapes: list[tuple[int, int]] = []
        length = extra = 0
        while True:
            match = _PLAIN.match(self._text, self._at)
            plain = match.group() if match else ""
            parts.append(plain)
            length += len(plain)
            self._at += len(plain)
            character = self._text[self._at : self._at + 1]
            if character == '"':
                self._at += 1
                return JsonString("".join(parts), start, tuple(escapes))
            if character != "\\":
                raise _Unreadable("this string is not closed on its line", start, "Write \\n for a newline")
            before = self._at
            parts.append(self._escape())
            extra += self._at - before - 1
            escapes.append((length, extra))
            length += 1

    def _escape(self) -> str:
        match = _ESCAPE.match(self._text, self._at)
        if match is None:
            raise _Unreadable("no such escape in JSON", self._at, "Write \\\\ for a backslash")
        self._at = match.end()
        if match.group(2):
            return _CONTROL.get(match.group(2), match.group(2))
        unit = int(match.group(1), 16)
        if 0xD800 <= unit < 0xDC00:
            low = _ESCAPE.match(self._text, self._at)
            if low is not None and low.group(1) and 0xDC00 <= int(low.group(1), 16) < 0xE000:
                self._at = low.end()
                return chr(0x10000 + ((unit - 0xD800) << 10) + int(low.group(1), 16) - 0xDC00)
        if 0xD800 <= unit < 0xE000:
            raise _Unreadable("half of a surrogate pair", match.start())
        if unit == 0:
            raise _Unreadable("a NUL character", match.start())
        return chr(unit)

    def _number_or_constant(self) -> JsonValue:
        start = self._at
        if number := _NUMBER.match(self._text, start):
            self._at = number.end()
            return JsonNumber(_number(number.group(), start), start)
        word = _WORD.match(self._text, start)
        if word is not None and word.group() in _CONSTANTS:
            self._at = word.end()
            return JsonConstant(_CONSTANTS[word.group()], start)
        hint = ""
        if word is not None and word.group() in _PYTHON_CONSTANTS:
            hint = f"Write {_PYTHON_CONSTANTS[word.group()]}"
        elif self._text[start : start + 1] == "'":
            hint = "Write double quotes"
        elif word is not None:
            hint = f'Text stands in double quotes: "{word.group()}"'
        raise _Unreadable(f"expected a value, found {self._found()}", start, hint)

    # --- between values ---

    def _skip_blank(self) -> None:
        while True:
            match = _BLANK.match(self._text, self._at)
            self._at = match.end() if match else self._at
            if self._text.startswith("//", self._at):
                end = self._text.find("\n", self._at)
            elif self._text.startswith("/*", self._at):
                end = self._text.find("*/", self._at + 2)
                if end < 0:
                    raise _Unreadable("this comment is never closed", self._at)
                end += 2
            else:
                return
            if not self._has_comments:
                self._has_comments = True
                self._findings.warning(
                    "AOS127", "JSON has no comments", self._source.span(self._at), "They are skipped"
                )
            self._at = end if end >= 0 else len(self._text)

    def _found(self) -> str:
        if self._at >= len(self._text):
            return "the end of the file"
        word = _WORD.match(self._text, self._at)
        return repr(word.group() if word else self._text[self._at])


def _number(text: str, offset: int) -> int | float:
    if len(text) > 40:
        raise _Unreadable("a number this long is surely a mistake", offset)
    if not any(character in text for character in ".eE"):
        return int(text)
    value = float(text)
    if value in (float("inf"), float("-inf")):
        raise _Unreadable("this number is too large", offset)
    return value


def code_snippet(source: Source, strings: tuple[JsonString, ...]) -> Snippet:
    """The code of a string, or of a list of lines; each line comes from where it stands in the source."""
    lines: list[str] = []
    origins: list[Span] = []
    escapes: list[tuple[int, int, int]] = []
    for string in strings:
        pieces = re.split(r"\r\n|\r|\n", string.text)
        separators = [len(match) for match in re.findall(r"\r\n|\r|\n", string.text)]
        widths = [len(piece) + gap for piece, gap in zip(pieces, [*separators, 0], strict=True)]
        starts = [0, *accumulate(widths)][: len(pieces)]
        for piece, start in zip(pieces, starts, strict=True):
            lines.append(piece)
            origins.append(source.span(string.offset_of(start)))
            wide = string.wide_characters(start, start + len(piece))
            escapes += [(len(lines), index - start + 1, width) for index, width in wide]
    return Snippet("\n".join(lines), tuple(origins), tuple(escapes))
