"""The numbers of an observation: values of the local variables that the skill's model reports."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from aos_protocol.codec import UNREADABLE


def observed_numbers(names: Iterable[str], local_variables: Mapping[str, str]) -> dict[str, Any]:
    """Returns by name a number, or a list of numbers with None for those that are missing.

    A local variable that is none of these, as text in `local_variables`, was not observed.
    """
    return numbers_among({name: _decoded(local_variables.get(name, "null")) for name in names})


def numbers_among(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns what counts as observed of what a program of the robot's may give as numbers."""
    return {name: value for name, value in values.items() if _is_number(value) or _is_list(value)}


def _decoded(text: str) -> Any:
    """Plain data from JSON; other objects are told by their `repr`, and are no numbers."""
    try:
        return msgspec.json.decode(text)
    except UNREADABLE:
        return None


def _is_number(value: Any) -> bool:
    try:
        return isinstance(value, bool | int | float) and math.isfinite(value)
    except OverflowError:  # No double is so large.
        return False


def _is_list(value: Any) -> bool:
    return isinstance(value, list) and all(item is None or _is_number(item) for item in value)
