"""The nodes of a syntax tree: their text, and all that is below one."""

from collections.abc import Iterator

from tree_sitter import Node


def text_of(node: Node) -> str:
    return (node.text or b"").decode("utf-8", "replace")


def field_of(node: Node, field: str) -> Node | None:
    """The part of a node in a field, such as `left`; None where it has none."""
    return node.child_by_field_name(field)


def field_text(node: Node, field: str) -> str:
    """The text of a node's field; empty where it has none."""
    part = field_of(node, field)
    return text_of(part) if part is not None else ""


def operator_of(node: Node) -> str:
    """The operator of an expression; empty where it has none."""
    return field_text(node, "operator")


def picks_member(node: Node) -> bool:
    """Returns whether this is `x.*m`, where a pointer says which field of `x` is meant."""
    return node.type == "field_expression" and operator_of(node) == ".*"


def below(node: Node | None) -> Iterator[Node]:
    """The node and all below it, in text order. They wait on a stack: no text is too deep to read."""
    waiting = [node] if node is not None else []
    while waiting:
        part = waiting.pop()
        yield part
        waiting += reversed(part.children)


def child_of(node: Node, field: str) -> Node:
    """The part of a node in a field; its first part where it has none."""
    child = field_of(node, field)
    return child if child is not None else node.children[0]


def names_of(node: Node | None) -> tuple[str, ...]:
    """The names of a qualified or templated name, without template arguments."""
    parts: list[str] = []
    while node is not None:
        if node.type == "qualified_identifier":
            scope = field_of(node, "scope")
            parts += [text_of(scope).split("<")[0]] if scope is not None else []
            node = field_of(node, "name")
        elif node.type in ("template_function", "template_method", "template_type", "dependent_name"):
            node = field_of(node, "name") or next(iter(node.named_children), None)
        else:
            parts.append(text_of(node))
            node = None
    return tuple(parts)
