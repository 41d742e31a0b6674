"""Numbers of the robot that are not finite, such as the NaN of a camera that sees nothing."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

_NAN = "NaN compares as false in rules: tell it apart in a first rule, as by `x != x`"
_INFINITE = "It lies beyond all limits of rules: tell it apart in a first rule, as by `abs(x) > 1e300`"


class OddNumbers:
    """Tells once of each field of results and messages that was NaN or infinite.

    Lists are left out: ranges of a scanner are infinite where nothing is in reach.
    """

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def take(self, what: str, fields: Mapping[str, Any]) -> list[str]:
        """Returns what is to be told of these fields; `what` says of what they are."""
        notices = []
        for field, number in _not_finite(fields):
            if (what, field) not in self._told:
                self._told.add((what, field))
                hint = _NAN if math.isnan(number) else _INFINITE
                notices.append(f"{field} of {what} is {number}, no finite number. {hint}")
        return notices


def _not_finite(fields: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    for name, value in fields.items():
        if isinstance(value, float) and not math.isfinite(value):
            yield f"{before}{name}", value
        elif isinstance(value, Mapping):
            yield from _not_finite(value, f"{before}{name}.")
