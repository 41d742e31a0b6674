"""Messages for places where a snippet is no C++."""

import re

from tree_sitter import Node

from aos_language.cpp.tree import text_of
from aos_protocol.spelling import nearest

_OTHER_LANGUAGES = (
    (re.compile(r"for\b[^;:]*\bin\b"), "A loop over a list is `for (auto x : list)`"),
    (re.compile(r"for\s*\([^;:()]*,"), "Semicolons divide the parts of a `for`"),
    (re.compile(r":="), "To set a variable, write `=`"),
)
"""Words of other languages, and what C++ says instead."""


def unexpected(node: Node) -> tuple[str, str]:
    """Returns the message and the hint for a part that the parser could not read."""
    text = text_of(node).strip().splitlines() or [""]
    before, after = node.prev_sibling, node.next_sibling
    is_cut = after and after.type != "}" and after.start_point[0] > node.end_point[0]
    is_behind = before and before.type not in ("{", "}", ";") and before.end_point[0] < node.start_point[0]
    line = "this line" if is_cut else "the line above" if is_behind else ""
    hint = f"Is a semicolon missing at the end of {line}?" if line else ""
    source = text_of(node) if after is None else text_of(node) + text_of(after)[:1]
    hint = next((told for found, told in _OTHER_LANGUAGES if found.match(source.lstrip())), hint)
    return f"unexpected {text[0][:40]!r}", hint


def mistaken_label(label: str, code: str) -> tuple[str, str] | None:
    """Returns the message and the hint for a label that was meant as `default:`, or that nothing goes to."""
    if nearest(label, ("default",)):
        return f"`{label}:` is a label", "Did you mean `default:`?"
    if re.search(rf"\bgoto\s+{label}\b", code) is None:
        return f"`{label}:` is a label", "No section has this word, and no `goto` names it"
    return None
