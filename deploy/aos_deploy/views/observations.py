"""Observations for people."""

from collections.abc import Mapping
from typing import Any


def observation_text(response: str, numbers: Mapping[str, Any]) -> str:
    """`scanned (beams = 1.2 3.4, tilt = 0.12)`; a number that is missing in an array is a dash, an empty
    text `""`."""
    response = response or '""'
    shown = ", ".join(f"{name} = {_numbers(value)}" for name, value in numbers.items())
    return f"{response} ({shown})" if shown else response


def _numbers(value: Any) -> str:
    values = value if isinstance(value, list | tuple) else [value]
    return " ".join("-" if element is None else f"{element:.4g}" for element in values)
