"""Values for people, in as many digits as their size asks for."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from msgspec.structs import replace

from aos_protocol.messages import ActionValue

_MOST_BEFORE_THE_POINT = 4
"""Each further digit takes the place of a decimal."""
_MOST_DECIMALS = 12
"""Smaller numbers are written with an exponent."""
_FINEST_DECIMALS = 300
_LAST_BITS = 1e-6
"""The share of the last digit by which a proven value may be off by rounding."""


class Digits(NamedTuple):
    """The form of numbers that are printed together: all have the same decimals, so that they compare."""

    decimals: int
    significant: int

    @classmethod
    def of(cls, values: Iterable[float], usual: int) -> "Digits":
        """Returns `usual` decimals where the largest value is from 1 to 9,999, else as many digits in all."""
        largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
        exponent = math.floor(math.log10(largest)) if largest else 0
        moved = min(exponent, 0) + max(exponent + 1 - _MOST_BEFORE_THE_POINT, 0)
        return cls(min(max(usual - moved, 0), _FINEST_DECIMALS), usual)

    @property
    def half_unit(self) -> float:
        """The smallest size that is not shown as 0."""
        return 0.5 * 10.0**-self.decimals

    def plain(self, value: float) -> str:
        return f"{value:{self._form}}"

    def signed(self, value: float) -> str:
        """The value with its sign; a dash where nothing is known of it."""
        return f"{value:+{self._form}}" if math.isfinite(value) else "-"

    def down(self, bound: float, slack: float = 0.0) -> float:
        """The bound rounded down, or up by `slack` of the last digit at most."""
        return self._rounded(bound, math.floor, slack)

    def up(self, bound: float, slack: float = 0.0) -> float:
        """The bound rounded up, or down by `slack` of the last digit at most."""
        return self._rounded(bound, math.ceil, slack)

    @property
    def _form(self) -> str:
        many = self.decimals > _MOST_DECIMALS
        return f".{self.significant}e" if many else f".{self.decimals}f"

    def _rounded(self, bound: float, towards: Callable[[float], int], slack: float) -> float:
        units = bound * 10.0**self.decimals
        nearest = round(units)
        return (nearest if abs(nearest - units) <= slack else towards(units)) / 10.0**self.decimals


def proven_texts(value: ActionValue, digits: Digits) -> tuple[str, str]:
    """The proven lower bound, rounded down, and the upper one, rounded up; nothing where none is known."""
    least, most = value.at_least, value.at_most
    return (
        "" if least is None else digits.signed(digits.down(least, _LAST_BITS)),
        "" if most is None else digits.signed(digits.up(most, _LAST_BITS)),
    )


def by_worth(values: Iterable[ActionValue], simulations: int) -> list[ActionValue]:
    """The values, the best first; last those of actions that the search has not tried, as no numbers."""
    known = [
        value if value.is_known(simulations) else replace(value, q=-math.inf, stderr=0.0) for value in values
    ]
    return sorted(known, key=lambda value: -value.q)
