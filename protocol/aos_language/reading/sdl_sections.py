"""A file's sections by word, their model code, and where words belong that its kind does not know."""

import re

import msgspec
from msgspec.structs import replace

from aos_language.findings import Findings
from aos_language.reading.document import check_name, enum_type, normal_type
from aos_language.reading.glued_else import with_else_apart
from aos_language.reading.sdl_text import Part, Section, enum_values, last_of
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import Text, expression
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Assignment, Iteration, Snippet, TemporaryVariable

DEFAULT_DISCOUNT = 0.9999

_KINDS = {
    ".ef": "the environment file (.ef)",
    ".sd": "a skill document (.sd)",
    ".am": "a mapping (.am)",
    ".lf": "the low-level file (.lf)",
}


def places_of_words(suffix: str) -> dict[str, str]:
    """Returns for the words that this kind of file does not know the kind in which they belong."""
    return {
        word: f"in {_KINDS[other]}"
        for other, grammar in GRAMMARS.items()
        for word in grammar
        if other != suffix and word not in GRAMMARS[suffix]
    }


class Sections:
    """A file's sections. `span` is the file's first line."""

    def __init__(self, sections: list[Section], span: Span, findings: Findings) -> None:
        self.span = span
        self._sections = sections
        self.findings = findings

    def of(self, *words: str) -> list[Section]:
        """The sections of any of these words, in order."""
        return [section for section in self._sections if section.word in words]

    def all(self, word: str) -> list[Section]:
        return self.of(word)

    def last(self, word: str) -> Section | None:
        """The last section of that word, as `last_of` has it; a second `project:` begins a document."""
        projects = [section.span.line for section in self.of("project")]
        return last_of(self.all(word), projects)

    def block(self, word: str) -> tuple[Assignment, ...]:
        """The model code of a section."""
        return read_block(self.last(word))

    def code(self, word: str) -> Snippet | None:
        """The code of a section that is one snippet."""
        section = self.last(word)
        return section.code() if section is not None else None


_TEMPORARY_ENUM = re.compile(r"enum\s+(\S+?)\s*\{(.*)\}\s*(\S+)")
_TYPE_AND_NAME = re.compile(r"(\S.*?)\s+(\S+)")
_LOOP_PARTS = ("loop_condition", "loop_body")


class _Open(msgspec.Struct):
    """An assignment that is being read."""

    span: Span
    name: str = ""
    temporary: TemporaryVariable | None = None
    over_previous: list[Iteration] = []
    over_next: list[Iteration] = []
    code: Snippet | None = None

    def closed(self) -> Assignment | None:
        """Returns the assignment of the block; None where nothing in it has an effect."""
        if not (self.temporary or self.over_previous or self.over_next or self.code):
            return None
        loops = tuple(self.over_previous), tuple(self.over_next)
        return Assignment(self.span, self.name, self.temporary, *loops, self.code)


def read_block(section: Section | None) -> tuple[Assignment, ...]:
    """The assignments of a section: its body is one, and each `assignment:` opens another."""
    if section is None:
        return ()
    body = section.code()
    found = [_Open(body.span, code=body)] if body is not None else []
    loops: list[Iteration] | None = None
    is_open = False
    for part in section.parts:
        if part.word == "assignment" or not is_open:
            found.append(_Open(part.span, name=" ".join(part.value.text.split())))
            is_open, loops = True, None
            if part.word == "assignment":
                continue
            found[-1].name = ""
        if part.word in _LOOP_PARTS:
            _add_to_loop(part, loops)
        elif part.word in ("loop_previous", "loop_next"):
            loops = found[-1].over_previous if part.word == "loop_previous" else found[-1].over_next
            loop = _loop(part)
            loops.extend([loop] if loop is not None else [])
        elif part.word == "temporary_variable":
            found[-1].temporary = _temporary(part)
        else:
            found[-1].code = part.code()
    closed = (assignment.closed() for assignment in found)
    return tuple(
        with_else_apart(assignment, section.findings) for assignment in closed if assignment is not None
    )


def _loop(part: Part) -> Iteration | None:
    match = _TYPE_AND_NAME.fullmatch(part.value.text)
    if match is None:
        message = f"`{part.word}:` needs a compound type and a name for each variable of it"
        part.findings.error("AOS104", message, part.place)
        return None
    check_name(Text(match.group(2), part.value.after(match.start(2)).span), "a loop's item", part.findings)
    return Iteration(match.group(1), match.group(2), part.value.span)


def _add_to_loop(part: Part, loops: list[Iteration] | None) -> None:
    code = part.code()
    if not loops:
        part.error("AOS104", f"this `{part.word}:` belongs to no loop")
    elif part.word == "loop_body":
        loops[-1] = replace(loops[-1], body=code)
    elif code is not None:
        loops[-1] = replace(loops[-1], condition=expression(code, drop_semicolon=True))


def _temporary(part: Part) -> TemporaryVariable | None:
    """`int n`, or `enum Ending { Good, Bad } ending` as in C++."""
    value = part.value
    if match := _TEMPORARY_ENUM.fullmatch(value.text):
        enum_name, name = (Text(match.group(i), value.after(match.start(i)).span) for i in (1, 3))
        check_name(enum_name, "an enum", part.findings)
        check_name(name, "a temporary variable", part.findings)
        listed = enum_values(Text(match.group(2), value.after(match.start(2)).span), part.findings)
        values = enum_type(enum_name, listed, part.findings).values
        return TemporaryVariable(name.text, "enum", name.span, enum_name.text, values)
    match = _TYPE_AND_NAME.fullmatch(value.text)
    if match is None:
        hint = "Write `int n`, or `enum Ending { Good, Bad } ending`"
        span = part.place
        part.findings.error("AOS104", f"`{part.word}:` needs a type and a name", span, hint)
        return None
    name = Text(match.group(2), value.after(match.start(2)).span)
    check_name(name, "a temporary variable", part.findings)
    kind = normal_type(Text(match.group(1), value.span), part.findings)
    return TemporaryVariable(name.text, kind, name.span)
