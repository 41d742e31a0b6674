"""SDL text cut into sections: a line that starts with a section's word and a colon opens it.

What follows the colon is the section's value, the lines below are its body. Which words open a section, and
which open a part of the one that is open, is the grammar of the file's kind. A word inside code is code:
`project::f()` opens nothing. Where no code is expected, a comment may end a line.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from enum import Enum
from typing import TypeVar

import msgspec

from aos_language.findings import Findings
from aos_language.reading.source import Source, Text, dedented, expression, without_blank_lines
from aos_protocol.diagnostics import Mend, Span
from aos_protocol.documents import Snippet
from aos_protocol.spelling import nearest

_OPENING = re.compile(r"[ \t\f\v]*([A-Za-z_]\w*)[ \t]*:(?!:)")
_APART = re.compile(r"[ \t]*([A-Za-z]+(?:[ -][A-Za-z]+)+)[ \t]*:(?!:)")
_WORD_ALONE = re.compile(r"[ \t]*(?P<word>[a-z]+(?:_[a-z]+)*)(?:[ \t]+(?P<rest>\S.*?))?[ \t]*$")
_BETWEEN_NAMES = frozenset({"and", "else", "for", "if", "in", "is", "not", "or"})
_COMMENT = re.compile(r"\s*(?://|#|/\*(?:(?!\*/).)*(?:\*/\s*)?$)")
_COMMENT_AFTER_VALUE = re.compile(r'(?:[^"\n]|"[^"\n]*")*?(?=\s(?://|#|/\*)(?:\s|$))')
_CODE_LABELS = frozenset({
    "case", "class", "def", "default", "elif", "else", "except", "finally", "for", "if", "lambda", "match",
    "private", "protected", "public", "try", "while", "with",
})  # fmt: skip


class Body(Enum):
    """The contents that may stand below a section's line."""

    NONE = "none"
    CPP = "C++"
    PYTHON = "Python"


class Word(msgspec.Struct, frozen=True):
    """A word of the grammar: what it means, what its body is, the words that open its parts, and its
    canonical spelling.

    `is_list` says that its value is a list, which goes on in the next line where a line ends with a comma.
    """

    meaning: str
    body: Body = Body.NONE
    parts: Mapping[str, Word] = {}
    canonical: str = ""
    is_list: bool = False


Grammar = Mapping[str, Word]


class Part(msgspec.Struct):
    """A word with its value and the lines below it."""

    word: str
    body: Body
    span: Span
    value: Text
    findings: Findings
    lines: list[Text] = []
    is_list: bool = False

    @property
    def place(self) -> Span:
        """The place of its value, or its own where it has none."""
        return self.value.span if self.value.text else self.span

    def error(self, code: str, message: str, hint: str = "") -> None:
        """Reports an error at the word."""
        self.findings.error(code, message, self.span, hint)

    def takes(self, line: Text) -> bool:
        """Returns whether a line below belongs to it."""
        if self.body is not Body.NONE or not self.is_list:
            return self.body is not Body.NONE
        given = [text for part in (self.value, *self.lines) if (text := part.text.strip())]
        return bool(line.text.strip()) and (not given or given[-1].endswith(","))

    def code(self) -> Snippet | None:
        """Value and body as code; None where there is none. Python loses its common indentation."""
        lines = [self.value, *self.lines] if self.value.text else self.lines
        if not any(line.text.strip() for line in lines):
            return None
        snippet = Snippet("\n".join(line.text for line in lines), tuple(line.span for line in lines))
        snippet = without_blank_lines(snippet)
        return dedented(snippet) if self.body is Body.PYTHON else snippet

    def expression(self) -> Snippet | None:
        """Returns `code` without the blanks around it."""
        code = self.code()
        return None if code is None else expression(code)


P = TypeVar("P", bound=Part)


class Section(Part):
    """A first-level part with the parts inside it, in order."""

    parts: list[Part] = []

    def all(self, word: str) -> Iterator[Part]:
        return (part for part in self.parts if part.word == word)

    def last(self, word: str) -> Part | None:
        """The part of that name; of several the last counts, with a warning."""
        return last_of(list(self.all(word)))

    def code_of(self, word: str) -> Snippet | None:
        """The code of the part of that name."""
        part = self.last(word)
        return part.code() if part is not None else None


def last_of(parts: list[P], ends: Collection[int] = ()) -> P | None:
    """The last of several parts of one name, with an error for each whose text would be lost.

    It is a warning where it says the same, or a document ends between them, on one of these lines.
    """
    for part in parts[:-1]:
        last, message = parts[-1], f"`{part.word}:` is given more than once"
        if _said(part) == _said(last) or any(part.span.line < line < last.span.line for line in ends):
            part.findings.warning("AOS125", message, part.span, f"The one on line {last.span.line} counts")
        else:
            hint = f"Only that on line {last.span.line} would count. Make one of them"
            part.findings.error("AOS103", message, part.span, hint)
    return parts[-1] if parts else None


def _said(part: Part) -> list[str]:
    inner = part.parts if isinstance(part, Section) else ()
    own = [text for line in (part.value, *part.lines) if (text := line.text.strip())]
    return own + [text for each in inner for text in (each.word, *_said(each))]


def listed_values(part: Part) -> list[Text]:
    """The names between commas in a part's value and the lines below it; an error where there are none."""
    lines = [line for line in (part.value, *part.lines) if line.text] or [part.value]
    if lines[0].text[:1] + lines[-1].text[-1:] in ("[]", "{}"):
        part.findings.warning("AOS127", "brackets around the names", lines[0].span, "They are skipped")
        lines[0] = lines[0].after(1).strip()
        lines[-1] = Text(lines[-1].text[:-1], lines[-1].span).strip()
    return [value for line in lines for value in enum_values(line, part.findings)]


def enum_values(text: Text, findings: Findings) -> list[Text]:
    """The names between commas; an error where there are none."""
    pieces = [text.after(match.start()) for match in re.finditer(r"(?<![^,])[^,]*", text.text)]
    values = [Text(piece.text.split(",")[0], piece.span).strip() for piece in pieces]
    values = [one for value in values for one in _apart(value, findings)]
    if values and not values[-1].text:  # A comma at the end.
        values.pop()
    if not values:
        findings.error("AOS105", "an enum needs names between commas", text.span)
    return values


def _apart(value: Text, findings: Findings) -> list[Text]:
    """The names of an enum between which commas are missing, with an error; else the value itself."""
    words = list(re.finditer(r"\S+", value.text))
    if len(words) < 2 or not all(word.group().isidentifier() for word in words):
        return [value]
    hint = f"Write `{', '.join(word.group() for word in words)}`"
    findings.error("AOS104", "a comma is missing between these values", value.span, hint)
    return [Text(word.group(), value.after(word.start()).span) for word in words]


def parse_sdl(
    source: Source, grammar: Grammar, elsewhere: Mapping[str, str], findings: Findings
) -> list[Section]:
    """The sections of a file in order. `elsewhere` says, for the words of other kinds, where they belong."""
    return _Scanner(source, grammar, elsewhere, findings).sections()


_MARKS = re.compile(
    r"""(?P<opens>/\*)|//|(?:^|\s)#|"(?:[^"\\]|\\.|\\$)*(?:"|$)|'(?:[^'\\]|\\.|\\$)*(?:'|$)"""
)


class _Scanner:
    def __init__(
        self, source: Source, grammar: Grammar, elsewhere: Mapping[str, str], findings: Findings
    ) -> None:
        self._source = source
        self._grammar = grammar
        below: dict[str, list[str]] = {}
        for word, entry in grammar.items():
            for part in entry.parts:
                below.setdefault(part, []).append(f"`{word}:`")
        self._below = {part: f"below {' or '.join(words[:2])}" for part, words in below.items()}
        self._elsewhere = {**elsewhere, **{part: self._below[part] for part in below if part in elsewhere}}
        self._findings = findings
        self._sections: list[Section] = []
        self._current: Part | None = None
        self._comment: Span | None = None
        self._stray_line = -1
        self._misplaced: set[str] = set()
        self._has_cpp = any(entry.body is Body.CPP for entry in grammar.values())

    def sections(self) -> list[Section]:
        for number, line in enumerate(self._source.lines, start=1):
            text = Text(line, Span(self._source.name, number, 1))
            if self._comment is None:
                self._take(text)
            elif self._is_in_code():
                self._add_to_body(text)
            self._note_comment(text)
        if self._comment is not None and not self._is_in_code():
            self._findings.error("AOS104", "this comment is never closed", self._comment)
        return self._sections

    def _note_comment(self, line: Text) -> None:
        """Notes whether a line ends within `/* ... */`, of which no line opens a section."""
        if not self._has_cpp or (self._current is not None and self._current.body is Body.PYTHON):
            return
        at = 0
        while at >= 0:
            if self._comment is None:
                marks = _MARKS.finditer(line.text, at)
                mark = next((mark for mark in marks if mark.group()[:1] not in ("'", '"')), None)
                if mark is None or not mark["opens"]:
                    return
                self._comment, at = line.after(mark.start()).span, mark.end()
            end = line.text.find("*/", at)
            self._comment, at = (self._comment, -1) if end < 0 else (None, end + 2)

    def _take(self, line: Text) -> None:
        match = _OPENING.match(line.text)
        name = match.group(1) if match else ""
        if match is not None and self._opens(name, line.after(match.start(1)), line.after(match.end())):
            return
        if not self._opens_apart(line) and not self._opens_without_colon(line):
            self._add_to_body(line)

    def _opens_apart(self, line: Text) -> bool:
        """Opens the section or part whose word a line has with blanks or hyphens for underscores."""
        match = _APART.match(line.text)
        if match is None:
            return False
        at, word = line.after(match.start(1)), re.sub("[ -]", "_", match[1])
        inner = self._grammar[self._sections[-1].word].parts if self._sections else {}
        if word not in inner and word not in self._grammar:
            return False
        mend = Mend(at.span, len(word), word)
        message, hint = f"unknown section `{match[1]}:`", f"Did you mean `{word}:`?"
        self._findings.error("AOS102", message, at.span, hint, mend)
        return self._opens(word, at, line.after(match.end()))

    def _opens_without_colon(self, line: Text) -> bool:
        """Opens the section or part that a line begins with where only its colon is missing."""
        match = _WORD_ALONE.match(line.text)
        if match is None:
            return False
        word = match["word"]
        inner = self._grammar[self._sections[-1].word].parts if self._sections else {}
        is_known = word in inner or word in self._grammar
        if not is_known or (self._is_in_code() and not self._is_no_code(word, match["rest"])):
            return False
        at = line.after(match.end("word"))
        mend = Mend(at.span, 0, ":")
        self._findings.error(
            "AOS104", f"a colon is missing after `{word}`", at.span, f"Write `{word}:`", mend
        )
        return self._opens(word, line.after(match.start("word")), at)

    def _is_no_code(self, word: str, rest: str) -> bool:
        """Returns whether a line in code that begins with a word of the grammar cannot be meant as code.

        A name stands alone in Python where it is an expression, which is one line.
        """
        assert self._current is not None
        is_first = not any(text.text.strip() for text in (self._current.value, *self._current.lines))
        if not rest:
            return "_" in word and not (self._current.body is Body.PYTHON and is_first)
        first = rest.split()[0]
        is_statement = rest.endswith((";", "{", "}", ":")) or first in _BETWEEN_NAMES
        # In Python `a -1` is an expression.
        is_number = re.fullmatch(r"[-\d][\d.]*" if self._current.body is Body.CPP else r"\d[\d.]*", rest)
        return (first.isidentifier() or is_number is not None) and not is_statement

    def _opens(self, name: str, at: Text, value: Text) -> bool:
        """Opens the section or part of that name; False where the line is no opening."""
        inner = self._grammar[self._sections[-1].word].parts if self._sections else {}
        is_part = True
        word = self._match(name, inner, at)
        if not word:
            is_part = False
            word = self._match(name, self._grammar, at)
        if not word:
            word, is_part = self._misspelt(name, inner, at)
        if not word:
            return self._reports_elsewhere(name, at)
        entry = inner[word] if is_part else self._grammar[word]
        canonical = entry.canonical or word
        value = value.strip() if entry.body is not Body.NONE else _without_comment(value)
        if is_part:
            self._current = Part(canonical, entry.body, at.span, value, self._findings, [], entry.is_list)
            self._sections[-1].parts.append(self._current)
        else:
            section = Section(canonical, entry.body, at.span, value, self._findings, parts=[])
            self._current = section
            self._sections.append(section)
            self._misplaced = set()
        return True

    def _match(self, name: str, words: Grammar, at: Text) -> str:
        if name in words:
            return name
        lower = name.lower()
        if lower not in words:
            return ""
        self._findings.warning("AOS127", f"`{name}:`", at.span, f"The word is `{lower}:`")
        return lower

    def _misspelt(self, name: str, inner: Grammar, at: Text) -> tuple[str, bool]:
        """The word a line that opens nothing was surely meant to be."""
        if name in _CODE_LABELS:
            return "", False
        is_of_others = name.lower() in self._elsewhere and ("_" in name or not self._is_in_code())
        if is_of_others or (name in self._below and self._is_word(name)):
            return "", False
        close = nearest(name, (*inner, *self._grammar))
        if not close or (self._is_in_code() and "_" not in close and len(close) < 8):
            return "", False
        mend = Mend(at.span, len(name), close)
        hint = f"Did you mean `{close}:`?"
        self._findings.error("AOS102", f"unknown section `{name}:`", at.span, hint, mend)
        return close, close in inner

    def _is_in_code(self) -> bool:
        return self._current is not None and self._current.body is not Body.NONE

    def _is_word(self, name: str) -> bool:
        """Returns whether a word of the grammar is meant as such: in code one with an underscore is."""
        return not self._is_in_code() or (name in self._below and ("_" in name or bool(self._misplaced)))

    def _is_in_rule(self) -> bool:
        """Returns whether the lines are a Python expression, in which `word:` begins no line."""
        current = self._current
        return current is not None and current.body is Body.PYTHON and "code" not in current.word

    def _reports_elsewhere(self, name: str, at: Text) -> bool:
        """Complains about a section of another kind of file, or of none; its lines are left out."""
        place = self._elsewhere.get(name)
        if place is None and (self._is_word(name) or self._is_in_rule()):
            place = self._below.get(name)
        if place is None and self._is_in_code():
            return False
        hint = f"It belongs {place}" if place else f"The sections are {', '.join(self._grammar)}"
        section = self._sections[-1].word if self._sections else ""
        if (name, section) == ("code", "special_state"):
            hint = "Write `reward_code:` in place of `special_state:`"
        elif (name, section) == ("type", "module_activation"):
            hint = "The type of a service or action is `srv:`"
        words = set(re.findall(r"`\w+:`", hint))
        if not words & self._misplaced:  # What belongs to one missing word is told once.
            self._findings.error("AOS102", f"`{name}:` has no place here", at.span, hint)
        self._misplaced = words
        self._current = Part(name, Body.CPP, at.span, Text("", at.span), self._findings)
        return True

    def _add_to_body(self, line: Text) -> None:
        is_comment = _COMMENT.match(line.text) is not None
        if self._current is not None and self._current.takes(line):
            if self._is_in_code():
                self._current.lines.append(line)
            elif not is_comment:
                self._current.lines.append(_without_comment(line))
        elif line.text.strip() and not is_comment:
            where = f"after `{self._current.word}:`" if self._current else "before the first section"
            if line.span.line != self._stray_line + 1:
                message = f"text {where} that belongs to no section"
                inner = self._grammar[self._sections[-1].word].parts if self._sections else {}
                hint = "Write `code:` above it" if "code" in inner else ""
                if self._current is not None and self._current.word == "enum_members":
                    hint = "Is a comma missing at the end of the line above?"
                self._findings.error("AOS104", message, line.strip().span, hint)
            self._stray_line = line.span.line


def _without_comment(value: Text) -> Text:
    """A line's value without the comment behind it and the blanks around it."""
    before = _COMMENT_AFTER_VALUE.match(value.text)
    return Text(before.group() if before else value.text, value.span).strip()
