"""The values that an expression of C++ can have: not those of its conditions and arguments."""

from collections.abc import Iterator

from tree_sitter import Node

from aos_language.cpp.nodes import field_of, operator_of
from aos_language.cpp.tree import tree_of

_VALUES = {
    "parenthesized_expression": (0,),
    "conditional_expression": (1, 2),
    "comma_expression": (-1,),
    "cast_expression": (-1,),
    "assignment_expression": (-1,),
    "subscript_expression": (0,),
}
"""The parts, by their places among the named ones, that give an expression its value."""


def value_names(expression: str) -> list[tuple[str, int]]:
    """The names with their offsets: of `is_there ? found : missed` these are `found` and `missed`.

    Of an element of an array it is the array's name, and of a list its elements'.
    """
    return [(text, offset) for kind, text, offset in values(expression) if kind == "identifier"]


def values(expression: str) -> list[tuple[str, str, int]]:
    """All that it can be the value of, each with what it is in the tree, its text and its offset.

    Behind a text in quotes and a `+` stands a value, too: that sum is no text where the value is none.
    """
    is_list = expression.lstrip().startswith("{")
    before, after = ("auto x = ", "\n;") if is_list else ("auto x = (", "\n);")
    data = f"{before}{expression}{after}".encode()
    found = []
    for node in _values(tree_of(data.decode())):
        start = len(data[: node.start_byte].decode()) - len(before)
        found.append((node.type, data[node.start_byte : node.end_byte].decode(), start))
    return found


def _values(root: Node) -> Iterator[Node]:
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if node.type == "init_declarator":
            value = field_of(node, "value")
            waiting += [value] if value is not None else []
        elif node.type in ("translation_unit", "declaration", "initializer_list"):
            waiting += reversed(node.named_children)
        elif node.type in _VALUES:
            parts = [part for part in node.named_children if part.type != "comment"]
            waiting += [parts[at] for at in reversed(_VALUES[node.type]) if at < len(parts)]
        elif node.type == "binary_expression" and node.named_children[0].type == "string_literal":
            waiting += node.named_children[1:2] if operator_of(node) == "+" else []
        else:
            yield node
