"""The types of the documents as C++ types of fixed storage."""

import re
from collections.abc import Iterable

from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import CompoundType, EnumType
from aos_solver.emission.lowering.capacities import GROWING_CAPACITY, Capacities
from aos_solver.emission.lowering.type_texts import (
    ARRAY,
    OVER_ENUM,
    SORTED,
    arguments,
    element_type,
    normal_type,
)
from aos_solver.emission.program import Axis, Enum

_PLAIN = frozenset({
    "anyValue", "bool", "char", "double", "float", "int", "int16_t", "int32_t", "int64_t", "int8_t", "long",
    "long int", "long long", "long long int", "short", "short int", "signed char", "size_t", "uint16_t",
    "uint32_t", "uint64_t", "uint8_t", "unsigned", "unsigned char", "unsigned int", "unsigned long",
    "unsigned long int", "unsigned long long", "unsigned long long int", "unsigned short",
    "unsigned short int",
})  # fmt: skip
_RANGE = re.compile(r"\(\s*(-?\d+)\s*,\s*(-?\d+)\s*,\s*([1-9]\d*)\s*\)")


def lower_enum(enum: EnumType) -> Enum:
    """The enum in the smallest type that holds its values and -1."""
    storage = next(bits for bits in (8, 16, 32) if len(enum.values) < 2 ** (bits - 1))
    return Enum(enum.name, enum.values, f"std::int{storage}_t")


def ordered_compounds(compounds: Iterable[CompoundType]) -> list[CompoundType]:
    """Compounds so that each stands behind those that it holds; a cycle is left in its order."""
    by_name = {compound.name: compound for compound in compounds}
    ordered: dict[str, CompoundType] = {}
    waiting = list(reversed(by_name.values()))
    opened: set[str] = set()
    while waiting:
        compound = waiting[-1]
        named = {name for field in compound.fields for name in re.findall(r"\w+", field.type)}
        needed = [by_name[name] for name in sorted(named & by_name.keys()) if name not in ordered]
        if compound.name in opened or not needed:
            waiting.pop()
            ordered.setdefault(compound.name, compound)
        else:
            opened.add(compound.name)
            waiting += needed
    return list(ordered.values())


class Types:
    """Resolves type texts.

    `members` are all names of variables, fields and parameters. A type with such a name has to be qualified.
    """

    def __init__(
        self,
        enums: Iterable[EnumType],
        compounds: Iterable[CompoundType],
        members: frozenset[str],
        capacities: Capacities,
        findings: Findings,
    ) -> None:
        self._enums = {enum.name: enum for enum in enums}
        self._named = self._enums.keys() | {compound.name for compound in compounds}
        self._members = members
        self._capacities = capacities
        self._findings = findings

    def stored(self, text: str, name: str, span: Span) -> str:
        """The type of a variable or field called `name`; AOS110 or AOS124, and `int`, if there is none."""
        return self._stored(text, name, span, level=0)

    def plain(self, text: str, span: Span) -> str:
        """The type of a parameter or a temporary variable, which is not bound to fixed storage."""
        text = normal_type(text)
        inner = element_type(text)
        if inner is not None:
            return f"std::vector<{self.plain(inner, span)}>"
        if (over := OVER_ENUM.fullmatch(text)) is not None:
            return self._over_enum(over[2], self.plain(over[1], span), span)
        if text == "string":
            return "std::string"
        if text in self._named or text in _PLAIN:
            return self._qualified(text)
        if re.search(r"\w\s*<", text):
            return text
        self._unknown(text, span)
        return "int"

    def axis(self, key: str, span: Span) -> Axis:
        """One key of a map variable: an enum's name, or `(start,stop,step)`."""
        if key in self._enums:
            name = self._qualified(key)
            return Axis(f"aos::EnumAxis<{name}, {len(self._enums[key].values)}>", name)
        match = _RANGE.fullmatch(key.strip())
        if match is None:
            hint = "A key is the name of an enum, or (start,stop,step) with a positive step"
            self._findings.error("AOS110", f"`{key}` cannot be the key of a map variable", span, hint)
            return Axis("aos::RangeAxis<0, 1, 1>", "int")
        return Axis(f"aos::RangeAxis<{', '.join(match.groups())}>", "int")

    def _stored(self, text: str, name: str, span: Span, level: int) -> str:
        text = normal_type(text)
        inner = element_type(text)
        if inner is not None:
            capacity = self._capacities.capacity(name, level)
            return f"aos::Vector<{self._stored(inner, name, span, level + 1)}, {capacity}>"
        if (over := OVER_ENUM.fullmatch(text)) is not None:
            return self._over_enum(over[2], self._stored(over[1], name, span, level + 1), span)
        array = ARRAY.fullmatch(text)
        if array is not None and array[2].isdecimal():
            return f"std::array<{self._stored(array[1], name, span, level + 1)}, {array[2]}>"
        if (sorted_type := SORTED.fullmatch(text)) is not None:
            return self._sorted(
                sorted_type[1].removeprefix("unordered_"), arguments(sorted_type[2]), name, span, level
            )
        if text == "string":
            return "aos::Text"
        if text in self._named or text in _PLAIN:
            return self._qualified(text)
        if re.search(r"\w\s*<", text) or text.endswith(("*", "&")):
            hint = "Use vector, pair, set or map, a compound type, or a map variable over finite keys"
            self._findings.error("AOS124", f"a state cannot hold a `{text}`", span, hint)
        else:
            self._unknown(text, span)
        return "int"

    def _sorted(self, kind: str, inner: list[str], name: str, span: Span, level: int) -> str:
        """A pair; or a set or a map, of as many keys as an enum has values, else as a vector elements."""
        stored = [self._stored(argument, name, span, level + 1) for argument in inner[:2]]
        element = f"aos::Pair<{', '.join(stored)}>" if kind in ("pair", "map") else stored[0]
        if kind == "pair":
            return element
        keys = self._enums.get(inner[0])
        # Code that indexes a map makes it grow.
        capacity = max(self._capacities.capacity(name, level), GROWING_CAPACITY if kind == "map" else 0)
        capacity = len(keys.values) if keys is not None else capacity
        return f"aos::{kind.title()}<aos::Vector<{element}, {capacity}>>"

    def _over_enum(self, enum: str, element: str, span: Span) -> str:
        if enum not in self._enums:
            known = ", ".join(sorted(self._enums)) or "none"
            message = f"`{enum}` is no enum, and cannot be what an array is indexed by"
            self._findings.error("AOS110", message, span, f"The enums are: {known}")
            return "int"
        return f"aos::Named<{self._qualified(enum)}, {len(self._enums[enum].values)}, {element}>"

    def _qualified(self, name: str) -> str:
        return f"model::{name}" if name in self._named and name in self._members else name

    def _unknown(self, text: str, span: Span) -> None:
        known = ", ".join(sorted(self._named))
        hint = f"The types are bool, int, float, double, string, anyValue{', ' + known if known else ''}"
        self._findings.error("AOS110", f"unknown type `{text}`", span, hint)
