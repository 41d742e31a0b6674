"""Observations and values for people."""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import msgspec

from aos_protocol.messages import ActionValue


def observation_text(response: str, numbers: Mapping[str, Any]) -> str:
    """`scanned (beams = 1.2 3.4, tilt = 0.12)`; a number that is missing in an array is a dash, an empty
    text `""`."""
    response = response or '""'
    shown = ", ".join(f"{name} = {_numbers(value)}" for name, value in numbers.items())
    return f"{response} ({shown})" if shown else response


def _numbers(value: Any) -> str:
    values = value if isinstance(value, list | tuple) else [value]
    return " ".join("-" if element is None else f"{element:.4g}" for element in values)


def value_text(value: float, digits: int) -> str:
    """An action's value; a dash where nothing is known of it."""
    return f"{value:+.{digits}f}" if math.isfinite(value) else "-"


def by_worth(values: Iterable[ActionValue], simulations: int) -> list[ActionValue]:
    """The values, the best first; last those of actions that the search has not tried, as no numbers."""
    known = [
        value if value.is_known(simulations) else msgspec.structs.replace(value, q=-math.inf, stderr=0.0)
        for value in values
    ]
    return sorted(known, key=lambda value: -value.q)


def at_least_text(value: ActionValue, digits: int) -> str:
    """The proven lower bound, rounded down; nothing where none is known."""
    return "" if value.at_least is None else _rounded(value.at_least, digits, math.floor)


def at_most_text(value: ActionValue, digits: int) -> str:
    """The proven upper bound, rounded up; nothing where none is known."""
    return "" if value.at_most is None else _rounded(value.at_most, digits, math.ceil)


def _rounded(bound: float, digits: int, towards: Callable[[float], int]) -> str:
    unit = 10.0**-digits
    # What is only off by rounding in the last bits would show as a unit.
    nearest = round(bound / unit)
    is_that = math.isclose(nearest * unit, bound, rel_tol=1e-9, abs_tol=1e-9)
    return f"{(nearest if is_that else towards(bound / unit)) * unit:+.{digits}f}"
