"""Numbers in results of skills that are not finite, such as the NaN of a camera that sees nothing."""

import logging
import math
from collections.abc import Iterator, Mapping
from typing import Any

_log = logging.getLogger("aos.middleware")


class OddNumbers:
    """Tells once of each field of a skill's results that was NaN or infinite, in the log.

    Lists are left out: ranges of a scanner are infinite where nothing is in reach.
    """

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def take_result(self, skill: str, fields: Mapping[str, Any]) -> None:
        """A skill has ended with these."""
        for field, number in _not_finite(fields):
            if (skill, field) not in self._told:
                self._told.add((skill, field))
                hint = "NaN compares as false in rules: tell it apart in a first rule, as by `x != x`"
                _log.warning("%s: %s of its result is %s, no finite number. %s", skill, field, number, hint)


def _not_finite(fields: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    for name, value in fields.items():
        if isinstance(value, float) and not math.isfinite(value):
            yield f"{before}{name}", value
        elif isinstance(value, Mapping):
            yield from _not_finite(value, f"{before}{name}.")
