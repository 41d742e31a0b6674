"""The nodes of a syntax tree: their text, their places in a snippet, and all that is below one."""

from bisect import bisect_left
from collections.abc import Iterator, Sequence

from tree_sitter import Node

from aos_language.cpp.tokens import Extent


def text_of(node: Node) -> str:
    return (node.text or b"").decode("utf-8", "replace")


def field_of(node: Node | None, field: str) -> Node | None:
    """The part of a node in a field, such as `left`; None where it has none."""
    return node.child_by_field_name(field) if node is not None else None


def parts_of(node: Node | None, field: str) -> Sequence[Node]:
    """The named parts of what a node has in a field, such as its `arguments`."""
    part = field_of(node, field)
    return part.named_children if part is not None else ()


def without_brackets(node: Node | None) -> Node | None:
    """The one expression inside all brackets around it; None where these have several parts, or none."""
    while node is not None and node.type in ("condition_clause", "parenthesized_expression"):
        node = node.named_children[0] if node.named_child_count == 1 else None
    return node


def field_text(node: Node | None, field: str) -> str:
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


class Places:
    """Places in `code`, of a tree of `complete`, the code with its missing semicolons and what surrounds it.

    `prefix` is how many characters stand before the code.
    """

    def __init__(self, code: str, complete: str, prefix: int, missing_semicolons: Sequence[int]) -> None:
        self._length = len(code)
        self._prefix = prefix
        self._offsets = _character_offsets(complete)
        self._inserted = [at + index for index, at in enumerate(missing_semicolons)]

    def extent(self, node: Node) -> Extent:
        """Returns where a node stands; what is around the code has a place without length."""
        return Extent(self.offset(node.start_byte), self.offset(node.end_byte))

    def offset(self, byte: int) -> int:
        """Returns the character of the code at a byte of the tree's text."""
        offset = max(byte - self._prefix, 0)
        if self._offsets is not None:
            offset = self._offsets[min(offset, len(self._offsets) - 1)]
        return min(offset - bisect_left(self._inserted, offset), self._length)


def _character_offsets(code: str) -> list[int] | None:
    """Returns the character that each byte of the UTF-8 text belongs to; None where they are the same."""
    if code.isascii():
        return None
    offsets = [index for index, character in enumerate(code) for _ in character.encode("utf-8", "replace")]
    return [*offsets, len(code)]
