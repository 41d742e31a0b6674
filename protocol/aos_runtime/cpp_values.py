"""Which lone names an expression of C++ can be the value of: not those of its conditions and arguments."""

from __future__ import annotations

from collections.abc import Iterator

import tree_sitter

from aos_runtime.cpp_tree import tree_of

__all__ = ["value_names"]

_BEFORE = "auto x = ("
_VALUES = {
    "parenthesized_expression": (0,),
    "conditional_expression": (1, 2),
    "comma_expression": (-1,),
    "cast_expression": (-1,),
    "assignment_expression": (-1,),
}
"""The parts, by their places among the named ones, that give an expression its value."""


def value_names(expression: str) -> list[tuple[str, int]]:
    """The names with their offsets: of `is_there ? found : missed` these are `found` and `missed`."""
    data = f"{_BEFORE}{expression}\n);".encode()
    names = []
    for node in _identifiers(tree_of(data.decode())):
        start = len(data[: node.start_byte].decode()) - len(_BEFORE)
        names.append((data[node.start_byte : node.end_byte].decode(), start))
    return names


def _identifiers(root: tree_sitter.Node) -> Iterator[tree_sitter.Node]:
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if node.type == "init_declarator":
            value = node.child_by_field_name("value")
            waiting += [value] if value is not None else []
        elif node.type in ("translation_unit", "declaration"):
            waiting += node.named_children
        elif node.type == "identifier":
            yield node
        elif node.type in _VALUES:
            parts = [each for each in node.named_children if each.type != "comment"]
            waiting += [parts[at] for at in reversed(_VALUES[node.type]) if at < len(parts)]
