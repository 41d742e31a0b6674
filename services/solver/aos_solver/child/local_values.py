"""The local variables of an outcome as an engine child reads them: values of C++ types, as numbers in a line.

The middleware tells them as text: JSON for plain data, Python's `repr` for the rest. The line is what
`StateReader` in state_text.hpp reads.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import msgspec

from aos_protocol.local_types import LocalType
from aos_solver.emission.program import Local

__all__ = ["UnusableLocals", "local_values_line"]

_INT_RANGE = range(-(2**31), 2**31)
_SHOWN_CHARACTERS = 60


class UnusableLocals(ValueError):
    """Local variables that have no value, or none of their types; the text names each of them."""


def local_values_line(wanted: Iterable[Local], texts: Mapping[str, str]) -> str:
    """The wanted values in their order; UnusableLocals if one is not there or of another type."""
    numbers: list[int] = []
    reasons: list[str] = []
    for local in wanted:
        text = texts.get(local.name, "null")
        try:
            numbers += _numbers(local.kind, msgspec.json.decode(text))
        except (msgspec.DecodeError, TypeError):
            reasons.append(_reason(local, text))
    if reasons:
        raise UnusableLocals("; ".join(reasons))
    return " ".join(map(str, numbers))


def _reason(local: Local, text: str) -> str:
    if text == "null":
        return f"{local.name} has no value"
    shown = text if len(text) <= _SHOWN_CHARACTERS else f"{text[:_SHOWN_CHARACTERS]}..."
    kind = f"{local.kind.element}[]" if local.kind.is_array else local.kind.element
    return f"{local.name} is {shown}, which is no {kind}"


def _numbers(kind: LocalType, value: Any) -> Iterator[int]:
    """TypeError if the value is of another type."""
    to_numbers = _OF_ELEMENT[kind.element]
    if not kind.is_array:
        yield from to_numbers(value)
        return
    if not isinstance(value, list):
        raise TypeError
    yield len(value)
    for item in value:
        yield from to_numbers(item)


def _of_bool(value: Any) -> Iterator[int]:
    if not isinstance(value, bool):
        raise TypeError
    yield int(value)


def _of_int(value: Any) -> Iterator[int]:
    if not isinstance(value, int) or isinstance(value, bool) or value not in _INT_RANGE:
        raise TypeError
    yield value


def _of_real(value: Any) -> Iterator[int]:
    """The bits of the number as a signed integer."""
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise TypeError
    yield from struct.unpack("<q", struct.pack("<d", value))


def _of_text(value: Any) -> Iterator[int]:
    if not isinstance(value, str):
        raise TypeError
    characters = value.encode()
    yield len(characters)
    yield from characters


_OF_ELEMENT: Mapping[str, Callable[[Any], Iterator[int]]] = {
    "bool": _of_bool,
    "int": _of_int,
    "float": _of_real,
    "double": _of_real,
    "string": _of_text,
}
