"""A question to the engine child, as the one line that `cpp/aos/child/command.hpp` reads.

The line is the command's name, its fields as `name=value`, and for a command that takes a list an empty field
and the items, all apart by tabs. Fields are known by their names; the child says which one is missing.
"""

from collections.abc import Iterable

_ESCAPES = str.maketrans({"\\": "\\\\", "\t": "\\t", "\n": "\\n"})


def command_line(command: str, items: Iterable[object] | None = None, /, **fields: object) -> str:
    """The line for a command. Fields that are None are left out, and truth is 1 or 0."""
    parts = [command, *(f"{name}={_text(value)}" for name, value in fields.items() if value is not None)]
    if items is not None:
        parts += ["", *map(_text, items)]
    return "\t".join(part.translate(_ESCAPES) for part in parts)


def with_change(command: str, change: int) -> str:
    """The line of a command with the number of the change that it makes."""
    before, tab, rest = command.partition("\t")
    return f"{before}\tchange={change}{tab}{rest}"


def _text(value: object) -> str:
    return str(int(value)) if isinstance(value, bool) else str(value)
