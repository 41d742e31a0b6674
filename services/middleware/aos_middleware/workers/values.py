"""The data that mapping code works on: robot data as objects with attributes, and its way back to plain data.

The bus carries plain data (numbers, texts, bytes, lists, dicts). Documents are written for message classes
of a robot framework: `__input.pose.x`, `Point(x=1.0)`. `Message` gives the first, `stand_in` the second where
the framework's class cannot be imported, and `plain_from` turns both, and the real classes, into plain data.
"""

import copy
import math
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import msgspec

from aos_protocol.spelling import nearest, shortened
from aos_runtime import plain_data

_KEPT_TEXTS = 2_000_000
_BEGINNING = 200


class Message:
    """A structure whose fields are attributes; made from field names and values."""

    def __init__(self, **fields: Any) -> None:
        self.__dict__.update(fields)

    def __getattr__(self, name: str) -> Any:
        known = list(self.__dict__)
        near = nearest(name, known)
        has = f"did you mean {near!r}?" if near else f"it has {', '.join(known) or 'no fields'}"
        raise AttributeError(f"no field {name!r}; {has}", name=name)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Message) and self.__dict__ == other.__dict__

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value!r}" for name, value in self.__dict__.items())
        return f"{type(self).__name__}({fields})"


def message_from(plain: Any) -> Any:
    """Plain data with every dict as a `Message`."""
    if isinstance(plain, Mapping):
        message = Message()
        message.__dict__.update({str(name): message_from(value) for name, value in plain.items()})
        return message
    if isinstance(plain, list | tuple):
        return [message_from(item) for item in plain]
    return plain


def plain_from(value: Any) -> Any:
    """The plain data of a value of mapping code; TypeError if it has none."""
    return plain_data.plain_from(value, (Message,))


def stand_in(name: str, module: str) -> type[Message]:
    """A class for `from module import name` where that cannot be imported: it takes any fields, by name."""

    def __init__(self: Message, *values: Any, **fields: Any) -> None:
        if values:
            raise TypeError(
                f"{module}.{name} cannot be imported here, and what stands in for it takes its fields by name"
            )
        Message.__init__(self, **fields)

    return type(name, (Message,), {"__init__": __init__, "__module__": module})


def low_level_type(name: str, *fields: str) -> type[Message]:
    """The class of a low-level type: every field is None until it is assigned."""

    def __init__(self: Message, **values: Any) -> None:
        Message.__init__(self, **{**dict.fromkeys(fields), **values})

    return type(name, (Message,), {"__init__": __init__})


def put(values: dict[str, Any], path: str, value: Any) -> None:
    """Sets what is at a path into nested dicts; nothing happens where the path leads nowhere."""
    *outer, last = path.split(".")
    inner: Any = values
    for name in outer:
        inner = inner.get(name) if isinstance(inner, dict) else None
    if isinstance(inner, dict) and last in inner:
        inner[last] = value


def share_what_cannot_be_copied(value: Any, shared: dict[int, Any]) -> None:
    """Adds to `shared`, a memo of `copy.deepcopy`, the smallest parts of a value without which it can be
    copied, such as a lock in a list."""
    waiting, seen = [value], set()
    while waiting:
        part = waiting[-1]
        if _can_be_copied(part, shared):
            waiting.pop()
            continue
        seen.add(id(part))
        if inner := [each for each in _parts(part) if id(each) not in seen]:
            waiting += inner
        else:
            shared[id(waiting.pop())] = part


def _can_be_copied(value: Any, shared: dict[int, Any]) -> bool:
    try:
        copy.deepcopy(value, dict(shared))
    except Exception:
        return False
    return True


def _parts(value: Any) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    if isinstance(value, list | tuple | set | frozenset):
        return list(value)
    return list(vars(value).values()) if isinstance(value, Message) else []


def is_truth(value: Any) -> bool:
    """Returns whether a value is True or False; those of numpy have no common class with Python's."""
    return isinstance(value, bool) or type(value).__name__ in ("bool", "bool_")


def text_of(value: Any) -> str:
    """A local variable's value for people and records: JSON where it is plain data, else its `repr`, as of a
    number that is not finite; its type where that raises, as for a whole number of 5,000 digits."""
    for text in (_plain_text, repr):
        with suppress(Exception):
            return text(value)
    return f"a value of type {type(value).__name__}"


def _plain_text(value: Any) -> str:
    plain = plain_from(value)
    is_json = not isinstance(plain, float) or math.isfinite(plain)
    return msgspec.json.encode(plain).decode() if is_json else str(plain)


def kept_texts(texts: Mapping[str, str]) -> dict[str, str]:
    """The texts of local variables for records, the shortest ones whole; the longest may be beginnings.

    Together they have some two million characters at most: a picture would be too large for the bus.
    """
    kept: dict[str, str] = {}
    left = _KEPT_TEXTS
    for name, text in sorted(texts.items(), key=lambda each: len(each[1])):
        kept[name] = text if len(text) <= left else shortened(text, _BEGINNING)
        left -= len(kept[name])
    return {name: kept[name] for name in texts}
