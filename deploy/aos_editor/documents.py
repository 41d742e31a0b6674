"""The contents of an SDL text at a place: the meaning of a word, the words that may stand there, its
outline, and the meaning of each built-in in one sentence."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import PurePath

import msgspec

from aos_language.findings import Findings
from aos_language.reading.sdl_text import Body, Part, Section, parse_sdl
from aos_language.reading.sdl_words import GRAMMARS
from aos_language.reading.source import Source

_NAME = re.compile(r"(?:AOS\.|AOSUtils::)?[A-Za-z_]\w*")
_LINE_START = re.compile(r"[ \t]*\w*\Z")
_BUILT_IN_START = re.compile(r"(?:AOS\.|AOSUtils::|__)\w*\Z")


class Proposal(msgspec.Struct, frozen=True):
    """A word to complete to: what is written, what it means, and how many characters it replaces."""

    label: str
    text: str
    meaning: str
    replaced: int


class Entry(msgspec.Struct, frozen=True):
    """A section or a part of one; lines from 1, `last_line` included. `title` is its value, or its word."""

    word: str
    title: str
    line: int
    column: int
    last_line: int
    parts: tuple[Entry, ...] = ()


def meaning_at(name: str, text: str, line: int, column: int) -> tuple[str, str] | None:
    """The word at a place (line from 1, column from 0) with its meaning; None where there is none."""
    suffix, source = PurePath(name).suffix.lower(), Source(name, text)
    if suffix not in GRAMMARS:
        return None
    for section in _sections(suffix, source):
        word = GRAMMARS[suffix][section.word]
        for part in (section, *section.parts):
            start = part.span.column - 1
            if part.span.line == line and start <= column <= start + len(part.word):
                return f"{part.word}:", (word if part is section else word.parts[part.word]).meaning
    for match in _NAME.finditer(source.line(line)):
        if match.start() <= column <= match.end() and match.group() in BUILT_INS:
            return match.group(), BUILT_INS[match.group()]
    return None


def proposals_at(name: str, text: str, line: int, column: int) -> list[Proposal]:
    """The words that may stand at a place: at a line's start those of the open section, then the sections;
    within code the built-ins."""
    suffix, source = PurePath(name).suffix.lower(), Source(name, text)
    if suffix not in GRAMMARS:
        return []
    before = source.line(line)[:column]
    if match := _BUILT_IN_START.search(before):
        typed = match.group()
        return [
            Proposal(word, word, meaning, len(typed))
            for word, meaning in BUILT_INS.items()
            if word.startswith(typed)
        ]
    if not _LINE_START.match(before):
        return []
    # The line that is being typed could itself be taken for a section; the ones above decide.
    above = Source(name, "\n".join(source.lines[: line - 1]))
    open_section = next(reversed(_sections(suffix, above)), None)
    return list(_words(suffix, open_section, len(before.lstrip())))


def _words(suffix: str, open_section: Section | None, replaced: int) -> Iterator[Proposal]:
    sections = GRAMMARS[suffix]
    parts = sections[open_section.word].parts if open_section is not None else {}
    for name, word in (*parts.items(), *sections.items()):
        if not word.canonical:
            opening = f"{name}: " if word.body is Body.NONE else f"{name}:\n"
            yield Proposal(f"{name}:", opening, word.meaning, replaced)


def outline(name: str, text: str) -> tuple[Entry, ...]:
    """The sections of an SDL text in order, each with its parts; nothing for other files."""
    suffix, source = PurePath(name).suffix.lower(), Source(name, text)
    if suffix not in GRAMMARS:
        return ()
    sections = _sections(suffix, source)
    ends = [*(section.span.line - 1 for section in sections[1:]), len(source.lines)]
    return tuple(_entry(section, end) for section, end in zip(sections, ends, strict=True))


def _entry(section: Section, last_line: int) -> Entry:
    ends = [*(part.span.line - 1 for part in section.parts[1:]), last_line]
    parts = tuple(_of(part, end) for part, end in zip(section.parts, ends, strict=False))
    return _of(section, last_line, parts)


def _of(part: Part, last_line: int, parts: tuple[Entry, ...] = ()) -> Entry:
    line, column = part.span.line, part.span.column
    return Entry(part.word, part.value.text or part.word, line, column, max(line, last_line), parts)


def _sections(suffix: str, source: Source) -> list[Section]:
    return parse_sdl(source, GRAMMARS[suffix], {}, Findings())


BUILT_INS: Mapping[str, str] = {
    "state": "The state before the step.",
    "state_": "The state after the extrinsic changes.",
    "state__": "The state after the skill: what the dynamic model writes.",
    "state___": "The state that a real observation corrects.",
    "__reward": "The reward of this code; all rewards of a step are added.",
    "__isGoalState": "Whether the mission ends in this state.",
    "__isFailureState": "Whether it ends as a failure. Code without this word lets the reward's sign say.",
    "__stopEvaluatingState": "Whether this special state is not looked at again.",
    "__meetPrecondition": "Whether the skill may be used; true at the start.",
    "__heuristicValue": "A skill's weight in play-outs, or a state's worth where the search ends.",
    "__possibleParameters": "The list of the skill's parameter values, as tuples.",
    "__moduleExecutionTime": "How long the skill takes.",
    "__moduleResponse": "The response the skill gives: one that its mapping names.",
    "__moduleResponseStr": "The response as any text.",
    "__observed": "Numbers beside the response: `__observed.NAME = AOS.SampleNormal(mean, deviation)`.",
    "__input": "The call's result, or the topic's message.",
    "AOS.Bernoulli": "`AOS.Bernoulli(p)`: true with probability p.",
    "AOS.SampleDiscrete": "`AOS.SampleDiscrete(Enum, {weights})`: a value, by normalised weights.",
    "AOS.SampleNormal": "`AOS.SampleNormal(mean, deviation)`: a draw from a normal distribution.",
    "AOS.SampleUniform": "`AOS.SampleUniform(low, high)`: a draw from a uniform distribution.",
    "AOS.SetNull": "Takes an `anyValue` away.",
    "AOS.IsInitialized": "Whether an `anyValue` is there.",
    "AOS.Initialize": "Says that an `anyValue` is there.",
    "AOS.Uninitialize": "Says that an `anyValue` is not there any more.",
    "AOSUtils::SampleDiscrete": "An index drawn with the given probabilities; -1 for what they miss to 1.",
}
"""Names that the system gives to model code and mapping code."""
