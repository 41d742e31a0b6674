"""The lengths that the vectors of a state can have: read off what the documents assign to them."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence

import msgspec
from msgspec.structs import replace

from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Access, Call, Cpp, Declaration, Mention, strip_comments
from aos_solver.emission.lowering.type_texts import SORTED, arguments, indexed_type, normal_type
from aos_solver.emission.lowering.vector_aliases import (
    GROWING,
    SIZING,
    aliases_of,
    bracketed_parts,
    fills_what_is_unclear,
    in_place_of_each_other,
    made_of,
    whole_number,
)

GROWING_CAPACITY = 64
"""A vector that grows by code gets this capacity, if nothing in the code tells more."""

REPORTED_CAPACITY = 1024
"""A vector that the robot's data fill gets this capacity, if the documents give it no length at the start."""

_MAX_CAPACITY = 16384
_MAX_TOLD = 1024
"""A larger number in code that sets variables up is hardly a length."""

_MAX_NESTING = 4
_MAPS = ("map<", "unordered_map<")
_FILLING = frozenset({"back_inserter", "exchange", "front_inserter", "inserter", "tie"})
"""Functions of the standard library that make what they are given longer, or whose result does."""
_NUMBER = r"(\d+(?:\s*[*+]\s*\d+)*)"
_LOOP_BOUND = re.compile(rf"\b(?:for\s*\([^;{{}}]*;|while\s*\()[^;{{}}]*?(?:<=?|!=)\s*{_NUMBER}\s*[;)]")
_LENGTH = re.compile(rf"(?<![\w.]){_NUMBER}(?![\w.])")
_NAMED = re.compile(r"\s*([A-Za-z_][\w.]*)\s*(?:[;,)}]|\Z)")
_CALLED = re.compile(r"\.\s*\w+\s*(?=\()")
_WHOLE = re.compile(
    r"(?:const(?:expr)? |static )*(?:auto|int|long|short|size_t|std::size_t|unsigned(?: int)?)(?: const)?"
)
_Key = tuple[str, int]
"""A name, and the level of nesting."""


class _Scope(msgspec.Struct, frozen=True):
    """Constants of one snippet by name, the keys of its own vectors, and how far a vector may grow in it."""

    numbers: Mapping[str, str]
    keys: Mapping[str, _Key]
    growth: int

    def number(self, text: str) -> int | None:
        return whole_number(with_numbers(text, self.numbers))


_NO_SCOPE = _Scope({}, {}, GROWING_CAPACITY)


class Capacities:
    """Capacity by the name of a variable or field and by level of nesting.

    A vector that is only ever assigned lists and literal sizes has exactly the capacity of the longest. One
    that grows has `GROWING_CAPACITY`, or the product of the loop bounds in the code that makes it grow, or
    the largest number up to `_MAX_TOLD` in code that sets variables up. One that the robot's data fill has
    twice the capacity it starts with, or `REPORTED_CAPACITY`. Running over is a fault at run time, with the
    document's line.
    """

    def __init__(
        self,
        filling: frozenset[str] = frozenset(),
        numbers: Mapping[str, str] | None = None,
        variables: Iterable[tuple[str, str]] = (),
        compounds: Mapping[str, Sequence[tuple[str, str]]] | None = None,
    ) -> None:
        """`filling` are functions that may make what they are given longer, `numbers` constants by name.
        Variables, and the fields of compounds, have a name and a type."""
        self._filling = filling
        self._numbers = dict(numbers or {})
        self._compounds = dict(compounds or {})
        fields = [field for fields in self._compounds.values() for field in fields]
        self._types = {name: normal_type(text) for name, text in (*fields, *variables)}
        self._known: dict[_Key, int] = {}
        self._grows: dict[_Key, int] = {}
        self._reported: set[_Key] = set()
        self._alike: dict[_Key, set[_Key]] = {}

    def capacity(self, name: str, level: int = 0) -> int:
        """The capacity of `name` at a level: 0 for the vector, 1 for the vectors in it."""
        alike = self._alike.get((name, level), {(name, level)})
        told = alike & (self._known.keys() | self._grows.keys() | self._reported)
        return max(map(self._own_capacity, told), default=GROWING_CAPACITY)

    def _own_capacity(self, key: _Key) -> int:
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
        self._take_value((name, 0), self._types.get(name, ""), strip_comments(expression), _NO_SCOPE)

    def read_code(self, snippets: Iterable[Cpp], *, sets_up: bool = False) -> None:
        """Takes in statements, which may be those that set the variables up."""
        for cpp in snippets:
            code = strip_comments(cpp.code)
            scope = self._scope_of(cpp, code, sets_up)
            aliases: dict[str, list[tuple[str, ...]]] = {
                name: [(key,)] for name, (key, _) in scope.keys.items()
            }
            for name, path in aliases_of(cpp):
                aliases.setdefault(name, []).append(path)
            for one, other in in_place_of_each_other(cpp, code):
                self._join(self._key(one.path), self._key(other.path))
            filled = [argument for call in cpp.calls if self._fills(call) for argument in call.arguments]
            is_unclear = fills_what_is_unclear(cpp, code, frozenset(aliases))
            for mention in cpp.mentions:
                if is_unclear and mention.path[0] in STATES:
                    self._grow_all(self._key(mention.path), scope)
                is_filled = any(argument.start <= mention.extent.start < argument.end for argument in filled)
                for start in aliases.get(mention.path[0], [mention.path[:1]]):
                    path = (*start, *mention.path[1:])
                    self._take_mention(replace(mention, path=path), code, scope)
                    if is_filled:
                        self._grow(self._key(path), scope)

    def _scope_of(self, cpp: Cpp, code: str, sets_up: bool) -> _Scope:
        """Reads the constants and the vectors that a snippet declares."""
        numbers = dict(self._numbers)
        changed = {m.path[0] for m in cpp.mentions if m.access not in (Access.READ, Access.CALL)}
        for one in cpp.declarations:
            if one.initial is not None and _WHOLE.fullmatch(one.type) and one.name not in changed:
                written = with_numbers(code[one.initial.start : one.initial.end].strip("(){}"), numbers)
                if (number := whole_number(written)) is not None:
                    numbers[one.name] = str(number)
        replaced = with_numbers(code, numbers)
        told = [_known_number(text) for text in _LENGTH.findall(replaced)] if sets_up else []
        growth = math.prod(max(1, _known_number(bound)) for bound in _LOOP_BOUND.findall(replaced))
        growth = max(GROWING_CAPACITY, growth, *(number for number in told if number <= _MAX_TOLD))
        keys: dict[str, _Key] = {}
        scope = _Scope(numbers, keys, growth)
        for one in cpp.declarations:
            if (key := self._own_vector(one, code, scope)) is not None:
                keys[one.name] = key
        return scope

    def _own_vector(self, one: Declaration, code: str, scope: _Scope) -> _Key | None:
        """Takes in a vector that code declares; its key, or None for what is none."""
        text = code[one.initial.start : one.initial.end] if one.initial is not None else ""
        kind = normal_type(one.type.removeprefix("const "))
        if kind == "auto" and (made := made_of(text)) is not None and made[0] == "vector":
            kind = "vector<>"
        if not (kind.startswith("vector<") and kind.endswith(">")):
            return None
        key = (f"{one.name} {len(self._types)}", 0)
        self._types[key[0]] = kind
        self._know(key, 0)
        if text:
            self._take_value(key, kind, "vector" + text if text.startswith("(") else text, scope)
        return key

    def _join(self, one: _Key, other: _Key) -> None:
        """Notes that two vectors, and those in them, are of one type, since code takes either."""
        for level in range(_MAX_NESTING):
            pair = ((one[0], one[1] + level), (other[0], other[1] + level))
            joined = {key for part in pair for key in self._alike.get(part, {part})}
            self._alike.update(dict.fromkeys(joined, joined))

    def _fills(self, call: Call) -> bool:
        if call.name[-1:] and call.name[-1] in _FILLING:
            return True
        return len(call.name) == 1 and call.name[0] in self._filling

    def _take_mention(self, mention: Mention, code: str, scope: _Scope) -> None:
        key = self._key(mention.path)
        rest = code[mention.extent.end :].lstrip()
        if mention.access is not Access.READ and self._kind((key[0], key[1] - 1)).startswith(_MAPS):
            self._grow((key[0], key[1] - 1), scope)
        if mention.access is Access.WRITE and rest.startswith("="):
            self._take_value(key, self._kind(key), rest[1:], scope)
        elif mention.method in GROWING:
            self._grow(key, scope)
        elif mention.method in SIZING:
            called = _CALLED.match(rest)
            parts = bracketed_parts(rest[called.end() :]) if called is not None else []
            if parts and parts[0].lstrip().startswith("{"):
                self._take_value(key, self._kind(key), parts[0].lstrip(), scope)
            else:
                self._take_length(key, parts, scope)

    def _take_value(self, key: _Key, kind: str, value: str, scope: _Scope) -> None:
        """Takes in a value of a type, nothing where it is unknown, which a text begins with."""
        made, named = made_of(value), _NAMED.match(value)
        if made is not None and made[1] == "{":
            self._take_list(key, kind, made[2], scope)
        elif made is not None and made[0] == "vector":
            self._take_length(key, made[2], scope)
        elif named is not None and (source := self._named_key(named[1], scope)) is not None:
            self._join(key, source)
        else:
            self._grow(key, scope)

    def _take_length(self, key: _Key, parts: Sequence[str], scope: _Scope) -> None:
        """Takes in a length, and what each element is: `(3)` and `(3, vector<int>(4))`."""
        length = scope.number(parts[0]) if parts else 0
        if length is None:
            self._grow(key, scope)
            return
        self._know(key, length)
        for part in parts[1:2]:
            self._take_part((key[0], key[1] + 1), indexed_type(self._kind(key)), part, scope)

    def _take_list(self, key: _Key, kind: str, parts: Sequence[str], scope: _Scope) -> None:
        """Takes in a list: for a vector its elements, for a map pairs, for a compound its fields."""
        below = (key[0], key[1] + 1)
        listed = SORTED.fullmatch(kind)
        if kind in self._compounds:
            inner = [((name, 0), normal_type(text)) for name, text in self._compounds[kind]]
        elif listed is not None and listed[1] == "pair":
            inner = [(below, text) for text in arguments(listed[2])]
        elif listed is not None and listed[1].endswith("map"):
            self._know(key, len(parts))
            inner = [(key, f"pair<{listed[2]}>")] * len(parts)
        else:
            self._know(key, len(parts))
            inner = [(below, indexed_type(kind))] * len(parts)
        for (place, type_), part in zip(inner, parts, strict=False):
            self._take_part(place, type_, part, scope)

    def _take_part(self, key: _Key, kind: str, text: str, scope: _Scope) -> None:
        """Takes in an element that is a list or a vector itself."""
        made, named = made_of(text), _NAMED.fullmatch(text)
        is_own = named is not None and named[1] in scope.keys
        if is_own or (made is not None and (made[1] == "{" or made[0] == "vector")):
            self._take_value(key, kind, text, scope)

    def _named_key(self, name: str, scope: _Scope) -> _Key | None:
        """The key of a vector of the code's own, or of a part of a state."""
        path = tuple(name.split("."))
        return self._key(path) if path[0] in STATES and path[1:] else scope.keys.get(name)

    def _key(self, path: tuple[str, ...]) -> _Key:
        """The name of a variable or field at the end of a path, and the level of what is indexed there."""
        is_inner = [
            part == "[]" or (part in ("first", "second") and part not in self._types) for part in path
        ]
        last = max((at for at, inner in enumerate(is_inner) if not inner), default=0)
        return path[last], len(path) - last - 1

    def _kind(self, key: _Key) -> str:
        """The type at a level; nothing where it is unknown."""
        kind = self._types.get(key[0], "") if key[1] >= 0 else ""
        for _ in range(key[1]):
            kind = indexed_type(kind)
        return kind

    def _know(self, key: _Key, size: int) -> None:
        self._known[key] = max(self._known.get(key, 1), size)

    def _grow_all(self, key: _Key, scope: _Scope) -> None:
        """Notes that a vector or what it holds may grow."""
        for level in range(key[1], _MAX_NESTING):
            self._grow((key[0], level), scope)

    def _grow(self, key: _Key, scope: _Scope) -> None:
        self._grows[key] = max(self._grows.get(key, GROWING_CAPACITY), scope.growth)


def with_numbers(code: str, numbers: Mapping[str, str]) -> str:
    """The code with constants' values in place of their names."""
    if not numbers:
        return code
    names = re.compile(rf"(?<![\w.])(?:state_*\.)?({'|'.join(map(re.escape, numbers))})(?![\w.\[(])")
    return names.sub(lambda name: numbers[name[1]], code)


def _known_number(text: str) -> int:
    return whole_number(text) or 0
