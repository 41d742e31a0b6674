"""The numbers of an observation: by name for people and messages, by number and index for an engine child."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from aos_solver.emission.program import Observed


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
