"""Plain data: numbers, texts, bytes, lists and dicts, which is what the bus carries.

People's code gives other things: numpy's numbers and arrays, enumerations, messages of a robot framework,
objects of their own classes. Each of them has plain data that it stands for.
"""

from collections.abc import Mapping
from enum import Enum
from typing import Any

MAX_DEPTH = 64
"""The levels of values in values; what contains itself has more."""


def check_depth(left: int) -> None:
    """Raises TypeError where no level is left."""
    if left == 0:
        raise TypeError(f"it is nested too deeply (more than {MAX_DEPTH} levels), or contains itself")


def plain_from(value: Any, structures: tuple[type, ...] = ()) -> Any:
    """The plain data of a value; TypeError if it has none.

    An object counts by its public fields: those in `__slots__`, where it has them, else its attributes. One
    of `structures` counts by all its attributes.
    """
    return _plain(value, structures, MAX_DEPTH)


def _plain(value: Any, structures: tuple[type, ...], depth: int) -> Any:
    check_depth(depth)
    if isinstance(value, Enum):
        return _plain(value.value, structures, depth - 1)
    if value is None or type(value) in (bool, int, float, str, bytes):
        return value
    if isinstance(value, bytearray | memoryview):
        return bytes(value)
    if isinstance(value, Mapping):
        return {str(name): _plain(item, structures, depth - 1) for name, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(item, structures, depth - 1) for item in value]
    is_structure = isinstance(value, structures)
    if not is_structure and hasattr(value, "tolist"):  # numpy's arrays and numbers
        return _plain(value.tolist(), structures, depth - 1)
    for primitive in (int, float, str):
        if isinstance(value, primitive):
            return primitive(value)
    fields = list(value.__dict__) if is_structure else _fields(value)
    if fields is None:
        raise TypeError(f"a value of type {type(value).__name__} is no plain data")
    return {name: _plain(getattr(value, name), structures, depth - 1) for name in fields}


def _fields(value: Any) -> list[str] | None:
    if isinstance(value, type) or callable(value):
        return None
    if hasattr(value, "get_fields_and_field_types"):  # ROS 2 messages; their slots are named otherwise
        return list(value.get_fields_and_field_types())
    slots = getattr(type(value), "__slots__", None)
    names = [slots] if isinstance(slots, str) else slots or getattr(value, "__dict__", None)
    return None if names is None else [name for name in names if not name.startswith("_")]
