"""A question to the engine child, as the one line that `cpp/aos/child/command.hpp` reads.

The line is the command's name, its fields as `name=value`, and for a command that takes a list an empty
field and the items, all apart by tabs. Fields are known by their names; the child says which one is missing.

Local variables and numbers of an outcome stand there as values of C++, as `StateReader` in state_text.hpp
reads them. The middleware tells them as text: JSON for plain data, Python's `repr` for the rest.
"""

import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any

import msgspec

from aos_protocol.codec import UNREADABLE
from aos_solver.emission.program import Local, Observed

_ESCAPES = str.maketrans({"\\": "\\\\", "\t": "\\t", "\n": "\\n"})


def command_line(command: str, items: Iterable[object] | None = None, /, **fields: object) -> str:
    """The line for a command. Fields that are None are left out, and truth is 1 or 0."""
    parts = [command, *(f"{name}={_text(value)}" for name, value in fields.items() if value is not None)]
    if items is not None:
        parts += ["", *map(_text, items)]
    return "\t".join(part.translate(_ESCAPES) for part in parts)


def with_change(command: str, change: int) -> str:
    """The line of a command with the number of the change that it makes."""
    before, tab, rest = command.partition("\t")
    return f"{before}\tchange={change}{tab}{rest}"


def _text(value: object) -> str:
    return str(int(value)) if isinstance(value, bool) else str(value)


_SHOWN_CHARACTERS = 60
_Int = Annotated[int, msgspec.Meta(ge=-(2**31), lt=2**31)]
_TYPES: Mapping[str, tuple[Any, Any]] = {
    "bool": (bool, list[bool]),
    "int": (_Int, list[_Int]),
    "float": (float, list[float]),
    "double": (float, list[float]),
    "string": (str, list[str]),
}
"""The types by element: that of one value, and that of an array."""


class UnusableLocals(ValueError):
    """Local variables that have no value, or none of their types; the text names each of them."""


def local_values_line(wanted: Iterable[Local], texts: Mapping[str, str]) -> str:
    """The wanted values in their order; UnusableLocals if one is not there or of another type."""
    numbers: list[int] = []
    reasons: list[str] = []
    for local in wanted:
        text = texts.get(local.name, "null")
        try:
            value = msgspec.json.decode(text, type=_TYPES[local.kind.element][local.kind.is_array])
        except UNREADABLE:
            reasons.append(_reason(local, text))
        else:
            numbers += numbers_of(value)
    if reasons:
        raise UnusableLocals("; ".join(reasons))
    return " ".join(map(str, numbers))


def _reason(local: Local, text: str) -> str:
    if text == "null":
        return f"{local.name} has no value"
    shown = text if len(text) <= _SHOWN_CHARACTERS else f"{text[:_SHOWN_CHARACTERS]}..."
    kind = f"{local.kind.element}[]" if local.kind.is_array else local.kind.element
    return f"{local.name} is {shown}, which is no {kind}"


def numbers_of(value: Any) -> Iterator[int]:
    """The numbers that stand for a value: a number itself, of a real one the bits as a signed integer; of a
    list or a text its size first."""
    if isinstance(value, float):
        yield from struct.unpack("<q", struct.pack("<d", value))
    elif isinstance(value, int):
        yield int(value)
    else:
        items = value.encode() if isinstance(value, str) else value
        yield len(items)
        for item in items:
            yield from numbers_of(item)


def numbers_field(observed: Sequence[Observed], numbers: Mapping[str, Any]) -> str:
    """The field of a command. A name without a number was not observed, nor was None in an array."""
    parts: list[str] = []
    for name, index, value in _single_numbers(observed, numbers):
        parts += str(name), str(index), repr(float(value))
    return " ".join(parts)


def _single_numbers(
    observed: Sequence[Observed], numbers: Mapping[str, Any]
) -> Iterator[tuple[int, int, float]]:
    for name, number in enumerate(observed):
        value = numbers.get(number.name)
        values = value if number.is_array and isinstance(value, list | tuple) else [value]
        yield from ((name, index, element) for index, element in enumerate(values) if element is not None)


def numbers_by_name(
    observed: Sequence[Observed], numbers: Iterable[tuple[int, int, float]]
) -> dict[str, float | list[float | None]]:
    """Returns the numbers that an engine child has told, by name."""
    named: dict[str, float | list[float | None]] = {}
    for name, index, value in numbers:
        number = observed[name]
        if not number.is_array:
            named[number.name] = value
            continue
        array = named.setdefault(number.name, [])
        assert isinstance(array, list)
        array += [None] * (index - len(array))
        array.append(value)
    return named
