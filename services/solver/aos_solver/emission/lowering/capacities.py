"""The lengths that the vectors of a state can have: read off what the documents assign to them."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise

import msgspec

from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Access, Call, Cpp, Mention, strip_comments

GROWING_CAPACITY = 64
"""A vector that grows by code gets this capacity, if nothing in the code tells more."""

REPORTED_CAPACITY = 1024
"""A vector that the robot's data fill gets this capacity, if the documents give it no length at the start."""

_MAX_CAPACITY = 16384
_MAX_NESTING = 4
_GROWING = frozenset({"emplace", "emplace_back", "insert", "merge", "push_back"})
_SIZING = frozenset({"assign", "resize"})
_FILLING = frozenset({"back_inserter", "exchange", "front_inserter", "inserter", "tie"})
"""Functions of the standard library that make what they are given longer, or whose result does."""
_NUMBER = r"\s*(\d+(?:\s*\*\s*\d+)*)\s*"  # or a product of numbers
_LOOP_BOUND = re.compile(rf"\bfor\s*\([^;{{}}]*;[^;{{}}]*<=?{_NUMBER};")
_CONSTRUCTED = re.compile(rf"(?:std::)?vector\s*<[^(){{}};]*>\s*\({_NUMBER}[,)]")
_COPIED = re.compile(r"state_*\.(?:\w+\.)*(\w+)\s*;")
_SIZED = re.compile(rf"\.\s*\w+\s*\({_NUMBER}[,)]")
_POINTER = re.compile(r"\bvector\s*<[\w\s:<>*]*>\s*\*")
_LOOP_COLON = re.compile(r"\s*:\s*")
_IN_PLACE = re.compile(r"\s*([:,]|\.\s*swap\s*\()\s*(&?)\s*")
_BEFORE_FIRST = re.compile(r"(?:(swap\s*\(\s*)|(&\s*))\Z")
_STATEMENT = re.compile(r"[^;{}]*\Z")
_LONGER = re.compile(r"=\s*(?:(?:std::)?vector\s*<|\{)")
_LISTED = re.compile(r"(?:std::)?vector\s*<[^(){};]*>\s*(?=\{)")


class Capacities:
    """Capacity by the name of a variable or field and by level of nesting.

    A vector that is only ever assigned lists and literal sizes has exactly the capacity of the longest. One
    that grows has `GROWING_CAPACITY`, or the product of the loop bounds in the code that makes it grow. One
    that the robot's data fill has twice the capacity it starts with, or `REPORTED_CAPACITY`. Running over is
    a fault at run time, with the document's line.
    """

    def __init__(
        self, filling: frozenset[str] = frozenset(), numbers: Mapping[str, str] | None = None
    ) -> None:
        """`filling` are functions that may make what they are given longer, `numbers` constants by name."""
        self._filling = filling
        self._numbers = dict(numbers or {})
        self._constant = re.compile(rf"\b(?:{'|'.join(self._numbers)})\b") if self._numbers else None
        self._known: dict[tuple[str, int], int] = {}
        self._grows: dict[tuple[str, int], int] = {}
        self._reported: set[tuple[str, int]] = set()
        self._alike: dict[tuple[str, int], set[tuple[str, int]]] = {}

    def capacity(self, name: str, level: int = 0) -> int:
        """The capacity of `name` at a level: 0 for the vector, 1 for the vectors in it."""
        return max(map(self._own_capacity, self._alike.get((name, level), {(name, level)})))

    def _own_capacity(self, key: tuple[str, int]) -> int:
        known = self._known.get(key, 0)
        if key in self._reported and known <= 1:  # An empty list at the start says nothing.
            return REPORTED_CAPACITY
        if known > 0 and key not in self._grows and key not in self._reported:
            return known
        return min(max(self._grows.get(key, GROWING_CAPACITY), 2 * known), _MAX_CAPACITY)

    def fill_by_report(self, name: str) -> None:
        """Takes in that a variable gets values from outside."""
        self._reported.add((name, 0))

    def read_default(self, name: str, expression: str) -> None:
        """Takes in the default value of a variable or field."""
        self._take_value((name, 0), strip_comments(expression).lstrip(), loops=1)

    def read_code(self, snippets: Iterable[Cpp]) -> None:
        """Takes in statements."""
        for cpp in snippets:
            code = strip_comments(cpp.code)
            loops = math.prod(_product(bound) for bound in _LOOP_BOUND.findall(self._in_numbers(code)))
            aliases: dict[str, list[tuple[str, ...]]] = {}
            for name, path in _aliases(cpp):
                aliases.setdefault(name, []).append(path)
            for one, other in _in_place_of_each_other(cpp, code):
                self._join(_key(one.path), _key(other.path))
            filled = [argument for call in cpp.calls if self._fills(call) for argument in call.arguments]
            is_unclear = _fills_what_is_unclear(cpp, code, frozenset(aliases))
            for mention in cpp.mentions:
                if is_unclear and mention.path[0] in STATES:
                    self._grow_all(_key(mention.path), loops)
                is_filled = any(argument.start <= mention.extent.start < argument.end for argument in filled)
                for start in aliases.get(mention.path[0], [mention.path[:1]]):
                    path = (*start, *mention.path[1:])
                    self._take_mention(msgspec.structs.replace(mention, path=path), code, loops)
                    if is_filled:
                        self._grow(_key(path), loops)

    def _join(self, one: tuple[str, int], other: tuple[str, int]) -> None:
        """Notes that two vectors, and those in them, are of one type, since code takes either."""
        for level in range(_MAX_NESTING):
            pair = ((one[0], one[1] + level), (other[0], other[1] + level))
            joined = {key for part in pair for key in self._alike.get(part, {part})}
            self._alike.update(dict.fromkeys(joined, joined))

    def _in_numbers(self, code: str) -> str:
        """The code with the constants' values in place of their names."""
        return self._constant.sub(lambda name: self._numbers[name[0]], code) if self._constant else code

    def _fills(self, call: Call) -> bool:
        if call.name[-1:] and call.name[-1] in _FILLING:
            return True
        return len(call.name) == 1 and call.name[0] in self._filling

    def _take_mention(self, mention: Mention, code: str, loops: int) -> None:
        key = _key(mention.path)
        rest = self._in_numbers(code[mention.extent.end :].lstrip())
        if mention.access is Access.WRITE and rest.startswith("="):
            self._take_value(key, rest[1:].lstrip(), loops)
        elif mention.method in _GROWING:
            self._grow(key, loops)
        elif mention.method in _SIZING:
            if (sized := _SIZED.match(rest)) is not None:
                self._know(key, _product(sized[1]))
            else:
                self._grow(key, loops)

    def _take_value(self, key: tuple[str, int], value: str, loops: int) -> None:
        if (constructed := _CONSTRUCTED.match(value)) is not None:
            self._know(key, _product(constructed[1]))
            return
        if (listed := _LISTED.match(value)) is not None:
            value = value[listed.end() :]
        if (copied := _COPIED.match(value)) is not None and copied[1] == key[0]:
            return
        if value.startswith("{"):
            for depth, count in enumerate(_list_lengths(value)):
                self._know((key[0], key[1] + depth), count)
        else:
            self._grow(key, loops)

    def _know(self, key: tuple[str, int], size: int) -> None:
        self._known[key] = max(self._known.get(key, 1), size)

    def _grow_all(self, key: tuple[str, int], loops: int) -> None:
        """Notes that a vector or what it holds may grow."""
        for level in range(key[1], _MAX_NESTING):
            self._grow((key[0], level), loops)

    def _grow(self, key: tuple[str, int], loops: int) -> None:
        self._grows[key] = max(self._grows.get(key, GROWING_CAPACITY), loops)


def _product(text: str) -> int:
    return math.prod(int(factor) for factor in text.split("*"))


def _aliases(cpp: Cpp) -> Iterator[tuple[str, tuple[str, ...]]]:
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


def _fills_what_is_unclear(cpp: Cpp, code: str, known: frozenset[str]) -> bool:
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
        if mention.method in _GROWING | _SIZING or is_set:
            return True
    return any(call.name in {(method,) for method in _GROWING} for call in cpp.calls)


def _in_place_of_each_other(cpp: Cpp, code: str) -> Iterator[tuple[Mention, Mention]]:
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


def _key(path: tuple[str, ...]) -> tuple[str, int]:
    """The name of a variable or field at the end of a path, and the level of what is indexed there."""
    last = max(index for index, part in enumerate(path) if part != "[]")
    return path[last], len(path) - last - 1


def _list_lengths(text: str) -> list[int]:
    """The most elements at each depth of a braced list, which `text` begins with."""
    lengths: list[int] = []
    open_lists: list[int] = []
    parentheses = 0
    is_inside_element = False
    for character in text:
        if character in "([":
            parentheses += 1
        elif character in ")]":
            parentheses -= 1
        if parentheses == 0 and character == "{":
            if open_lists and not is_inside_element:
                open_lists[-1] += 1
            open_lists.append(0)
            is_inside_element = False
        elif parentheses == 0 and character == "}":
            depth, count = len(open_lists) - 1, open_lists.pop()
            lengths += [0] * (depth + 1 - len(lengths))
            lengths[depth] = max(lengths[depth], count)
            is_inside_element = True
            if not open_lists:
                break
        elif parentheses == 0 and character == ",":
            is_inside_element = False
        elif not character.isspace() and not is_inside_element:
            open_lists[-1] += 1
            is_inside_element = True
    return lengths
