"""The nodes of a syntax tree: their text, and all that is below one."""

from collections.abc import Iterator

import tree_sitter


def text_of(node: tree_sitter.Node) -> str:
    """The text of a node."""
    return (node.text or b"").decode("utf-8", "replace")


def field_text(node: tree_sitter.Node, field: str) -> str:
    """The text of a node's field, such as `left`; empty where it has none."""
    part = node.child_by_field_name(field)
    return text_of(part) if part is not None else ""


def operator_of(node: tree_sitter.Node) -> str:
    """The operator of an expression; empty where it has none."""
    return field_text(node, "operator")


def picks_member(node: tree_sitter.Node) -> bool:
    """Returns whether this is `x.*m`, where a pointer says which field of `x` is meant."""
    return node.type == "field_expression" and operator_of(node) == ".*"


def below(node: tree_sitter.Node | None) -> Iterator[tree_sitter.Node]:
    """The node and all below it, in text order. They wait on a stack: no text is too deep to read."""
    waiting = [node] if node is not None else []
    while waiting:
        part = waiting.pop()
        yield part
        waiting += reversed(part.children)
