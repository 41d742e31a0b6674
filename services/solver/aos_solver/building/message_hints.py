"""Hints for messages of the compiler that name another language's word, or one sign in place of another.

Messages about map variables know them by the class that holds them, and are told in the documents' words.
"""

import re

from aos_solver.building.type_words import STATE_PART

_MEMBERS = {
    "add": "insert", "append": "push_back", "isEmpty": "empty", "is_empty": "empty", "items": "begin",
    "len": "size", "length": "size", "pop": "pop_back", "push": "push_back", "remove": "erase",
}  # fmt: skip
"""Members as other languages call them."""
_HINTS = (
    (
        re.compile(r"conversion from `(\w+)\*` to non-scalar type `\1` requested"),
        r"The list holds pointers: write `\1*`",
    ),
    (re.compile(r"base operand of `->` has non-pointer type `.*`"), "Write `.` in place of `->`"),
    (
        re.compile(r"return-statement with a value, in function returning `void`"),
        "Set `__meetPrecondition`, `__reward` or `__moduleResponse`, and write `return;`",
    ),
    (re.compile(r"`format` is not a member of `std`"), "Write `std::to_string`, and join texts with `+`"),
    (re.compile(r"invalid use of member function .*"), "It is called with brackets behind it: `(...)`"),
    (
        re.compile(r"expected primary-expression before `\.` token"),
        "A value of an enum is written by its name alone",
    ),
    (
        re.compile(r"cannot convert `std::string` to `int` in assignment"),
        "A response that is a text is given to `__moduleResponseStr`",
    ),
)
_NO_MEMBER = re.compile(r"`.*` has no member named `(\w+)`")


def hint_for(message: str) -> str:
    """The hint for a message in the documents' words; empty where none is known."""
    if (member := _NO_MEMBER.fullmatch(message)) is not None:
        return f"C++ writes `.{_MEMBERS[member[1]]}`" if member[1] in _MEMBERS else ""
    for pattern, hint in _HINTS:
        if (found := pattern.fullmatch(message)) is not None:
            return found.expand(hint)
    return ""


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
