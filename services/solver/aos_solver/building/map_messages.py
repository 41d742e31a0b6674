"""The compiler's messages about map variables, which know them by the class that holds them."""

import re

from aos_solver.building.type_words import STATE_PART

_MAP = re.compile(
    r"(?:const )?(?:class )?aos::Table<((?:[^<>]|<[^<>]*>)*?),\s*(aos::(?:Enum|Range)Axis<.*?>)\s*>"
)
_KEYS = re.compile(r"EnumAxis<(\w+), ?\d+>|RangeAxis<(-?\d+), ?(-?\d+), ?(-?\d+)>")
_VALUE = re.compile(r"no match for `operator=`")
_INDEX = re.compile(r"no match for `operator\[\]`|no viable overloaded operator\[\]")


def told_of_a_map(text: str) -> tuple[str, str] | None:
    """Returns the message in the documents' terms with its hint; None if it is about no map variable."""
    found = _MAP.search(text)
    if found is None:
        return None
    keys = ", ".join(_key(*parts) for parts in _KEYS.findall(found[2]))
    name = named[1] + named[2] if (named := STATE_PART.search(text)) else "state.NAME"
    hint = f"An element of it is `{name}[{{...}}]`, with a key for each of {{{keys}}}"
    if _VALUE.search(text):
        return "a map variable takes no value as a whole", hint
    if _INDEX.search(text):
        return f"the keys of this map variable are {{{keys}}}, and these are others", hint
    return _MAP.sub(f"map of {found[1]}", STATE_PART.sub(r"\1\2", text)), hint


def _key(enum: str, start: str, stop: str, step: str) -> str:
    return enum or f"({start},{stop},{step})"
