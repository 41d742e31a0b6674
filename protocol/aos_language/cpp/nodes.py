"""The nodes of a syntax tree: their text, and all that is below one."""

from collections.abc import Iterator

import tree_sitter


def text_of(node: tree_sitter.Node) -> str:
    """The text of a node."""
    return (node.text or b"").decode("utf-8", "replace")


def picks_member(node: tree_sitter.Node) -> bool:
    """Returns whether this is `x.*m`, where a pointer says which field of `x` is meant."""
    operator = node.child_by_field_name("operator") if node.type == "field_expression" else None
    return operator is not None and text_of(operator) == ".*"


def below(node: tree_sitter.Node | None) -> Iterator[tree_sitter.Node]:
    """The node and all below it, in text order. They wait on a stack: no text is too deep to read."""
    waiting = [node] if node is not None else []
    while waiting:
        part = waiting.pop()
        yield part
        waiting += reversed(part.children)
