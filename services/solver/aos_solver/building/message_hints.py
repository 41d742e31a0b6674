"""Hints for messages of the compiler that name another language's word, or one sign in place of another."""

import re

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
