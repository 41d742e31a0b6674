"""The vectors that code reaches by other names, makes longer, or writes as lists."""

import math
import re
from collections.abc import Iterator
from itertools import pairwise

from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Access, Cpp, Mention

GROWING = frozenset({"emplace", "emplace_back", "insert", "merge", "push_back"})
SIZING = frozenset({"assign", "reserve", "resize"})
_POINTER = re.compile(r"\bvector\s*<[\w\s:<>*]*>\s*\*")
_LOOP_COLON = re.compile(r"\s*:\s*")
_IN_PLACE = re.compile(r"\s*([:,]|\.\s*swap\s*\()\s*(&?)\s*")
_BEFORE_FIRST = re.compile(r"(?:(swap\s*\(\s*)|(&\s*))\Z")
_STATEMENT = re.compile(r"[^;{}]*\Z")
_LONGER = re.compile(r"=\s*(?:(?:std::)?vector\s*<|\{)")


def aliases_of(cpp: Cpp) -> Iterator[tuple[str, tuple[str, ...]]]:
    """The references that a snippet declares, and the paths that they stand for; and the copies by `auto`,
    which have the capacity of what they are made of."""
    for declaration in cpp.declarations:
        is_copy = declaration.type == "auto"
        if not is_copy and not declaration.type.endswith("&"):
            continue
        initial = declaration.initial
        loop = _LOOP_COLON.match(cpp.code, declaration.extent.end) if initial is None else None
        for mention in cpp.mentions:
            at = mention.extent.start
            if is_copy and mention.method:
                continue
            if initial is not None and (
                initial.start <= at < initial.end if is_copy else at == initial.start
            ):
                yield declaration.name, mention.path
            elif loop is not None and at == loop.end():
                yield declaration.name, (*mention.path, "[]")


def fills_what_is_unclear(cpp: Cpp, code: str, known: frozenset[str]) -> bool:
    """Returns whether code makes something longer through a reference, a pointer or a call's result.

    `known` are names whose places in the state are told.
    """
    types = {declaration.name: declaration.type for declaration in cpp.declarations}
    for mention in cpp.mentions:
        name, *rest = mention.path
        kind = types.get(name, "")
        is_iterator = kind == "auto" and rest[:1] in (["first"], ["second"])
        is_pointer = name not in STATES and code.startswith("->", mention.extent.end)
        is_unclear = kind.endswith(("&", "*")) or is_iterator
        if not is_pointer and (name in known or not is_unclear):
            continue
        is_set = mention.access is Access.WRITE and _LONGER.match(code[mention.extent.end :].lstrip())
        if mention.method in GROWING | SIZING or is_set:
            return True
    return any(call.name in {(method,) for method in GROWING} for call in cpp.calls)


def in_place_of_each_other(cpp: Cpp, code: str) -> Iterator[tuple[Mention, Mention]]:
    """Pairs as in `c ? state.a : state.b`, `{&state.a, &state.b}`, `swap(state.a, state.b)`, and
    `state.a.swap(state.b)`; and what pointers to vectors are set to."""
    if _POINTER.search(code):
        yield from pairwise(m for m in cpp.mentions if m.path[0] in STATES and m.access is Access.BIND)
    for one, other in pairwise(cpp.mentions):
        between = _IN_PLACE.fullmatch(code, one.extent.end, other.extent.start)
        if between is None:
            continue
        statement = _STATEMENT.search(code, 0, one.extent.start)
        before = _BEFORE_FIRST.search(code, 0, one.extent.start)
        is_choice = between[1] == ":" and statement is not None and "?" in statement[0]
        is_listed = between[1] == "," and before is not None and bool(before[2]) == bool(between[2])
        if is_choice or is_listed or between[1][0] == ".":
            yield one, other


_PRODUCT = r"\d+(?:\s*\*\s*\d+)*"
_SUM = re.compile(rf"\s*({_PRODUCT}(?:\s*[+-]\s*{_PRODUCT})*)\s*")
_TERM = re.compile(rf"([+-]?)\s*({_PRODUCT})")
_MADE = re.compile(r"\s*(?:std::)?([A-Za-z_]\w*|)\s*(?:<[^(){};]*>)?\s*(?=[({])")


def whole_number(text: str) -> int | None:
    """The value of a number, or of a sum of products of numbers; None for other texts."""
    if _SUM.fullmatch(text) is None:
        return None
    terms = _TERM.findall(text)
    return sum((-1 if sign == "-" else 1) * math.prod(map(int, term.split("*"))) for sign, term in terms)


def made_of(text: str) -> tuple[str, str, list[str]] | None:
    """The type's name, the bracket, and the parts, of a text that begins with `{...}`, `Type{...}` or
    `Type(...)`."""
    match = _MADE.match(text)
    if match is None:
        return None
    return match[1], text[match.end()], bracketed_parts(text[match.end() :])


def bracketed_parts(text: str) -> list[str]:
    """The parts between the commas of the bracket that a text begins with."""
    parts, depth, quote, before = [""], 0, "", ""
    for character in text:
        is_quoted, escaped = bool(quote), before == "\\"
        if is_quoted:
            quote = "" if character == quote and not escaped else quote
        elif character in "\"'":
            quote = character
        elif character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        if depth == 0:
            break
        if depth == 1 and character == "," and not is_quoted:
            parts.append("")
        else:
            parts[-1] += character
        before = "" if escaped else character
    first, *others = parts
    return [part for part in (first[1:], *others) if part.strip()]
