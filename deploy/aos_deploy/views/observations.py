"""Observations and values for people."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

__all__ = ["observation_text", "value_text"]


def observation_text(response: str, numbers: Mapping[str, Any]) -> str:
    """`scanned (beams = 1.2 3.4, tilt = 0.12)`; a number that is missing in an array is a dash."""
    told = ", ".join(f"{name} = {_numbers(value)}" for name, value in numbers.items())
    return f"{response} ({told})" if told else response


def _numbers(value: Any) -> str:
    values = value if isinstance(value, list | tuple) else [value]
    return " ".join("-" if each is None else f"{each:.4g}" for each in values)


def value_text(value: float, digits: int) -> str:
    """An action's value; a dash where a policy never chooses the action and knows nothing of it."""
    return f"{value:+.{digits}f}" if math.isfinite(value) else "-"
