"""C++ text as a syntax tree, the only door to the parser of tree-sitter, and the nodes of one."""

import re
import time
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from functools import cache

import tree_sitter
import tree_sitter_cpp
from tree_sitter import Node

from aos_language.cpp.tokens import Extent

MAX_CPU_S = 2.0
"""A text that is far from C++ takes the parser time that grows faster than the text."""
_SHORT_BYTES = 10_000
_PIECE_BYTES = 65536
_LANGUAGE = tree_sitter.Language(tree_sitter_cpp.language())
_PARSER = tree_sitter.Parser(_LANGUAGE)
_FUNCTION = "(function_declarator declarator: (identifier)) @declared"
_DECLARED = (
    f"(declaration declarator: [{_FUNCTION} (reference_declarator {_FUNCTION})"
    f" (pointer_declarator declarator: {_FUNCTION})])"
)
_LETTER = rb"[A-Za-z_$\x80-\xff]"
_MAY_DECLARE = re.compile(
    rb"(?:(?<!return)\s|[>&*/)\]])\s*(?!(?:if|for|while|switch|return)\b)"
    rb"%s(?:%s|\d)*(?:\s|\\|/\*.*?\*/|//[^\n]*\n)*\(" % (_LETTER, _LETTER),
    re.DOTALL,
)
"""A name and a bracket behind a type: each function that a body declares has them, most texts have not."""


@cache
def _local_functions() -> tree_sitter.Query:
    """The query for them, which takes 30 ms to make: commands that meet none do without."""
    return tree_sitter.Query(
        _LANGUAGE,
        f"[(compound_statement {_DECLARED}) (case_statement {_DECLARED}) (for_statement {_DECLARED})]",
    )


def tree_of(text: str) -> Node:
    """The root of the tree of any text; places in it count bytes of UTF-8.

    `Row row(amount);` and `int& one(total);` in a body, which might declare a function, are read as `Row
    row{amount};` and `int& one{total};`.
    """
    data = text.encode("utf-8", "replace")
    return _with_variables(_PARSER.parse(data).root_node, data)


def tree_soon(text: str) -> Node | None:
    """The same; None where that takes more than `MAX_CPU_S` of processor time."""
    data = text.encode("utf-8", "replace")
    if len(data) <= _SHORT_BYTES:
        return _with_variables(_PARSER.parse(data).root_node, data)
    started_s = time.thread_time()

    def is_over(*_: object) -> bool:
        return time.thread_time() - started_s > MAX_CPU_S

    try:
        root = _PARSER.parse(
            lambda offset, _: data[offset : offset + _PIECE_BYTES], progress_callback=is_over
        ).root_node
    except ValueError:
        _PARSER.reset()
        return None
    return _with_variables(root, data)


def _with_variables(root: Node, data: bytes) -> Node:
    """The tree with the variables that the parser has taken for functions."""
    if _MAY_DECLARE.search(data, max(data.find(b"{"), 0)) is None:
        return root
    starts = _starts(root)
    if not starts:
        return root
    text = bytearray(data)
    for values in starts:
        text[values.start_byte : values.start_byte + 1] = b"{"
        text[values.end_byte - 1 : values.end_byte] = b"}"
    return _PARSER.parse(bytes(text)).root_node


def _starts(root: Node) -> list[Node]:
    """The values in brackets that were read as the parameters of a function."""
    declared = tree_sitter.QueryCursor(_local_functions()).captures(root).get("declared", ())
    lists = [node.child_by_field_name("parameters") for node in declared]
    return [values for values in lists if values is not None and _are_values(values)]


def _are_values(parameters: Node) -> bool:
    """Returns whether what was read as parameters has neither names nor types of C++ alone."""
    for part in parameters.named_children:
        if part.is_error:
            continue
        declarator = part.child_by_field_name("declarator")
        is_named = declarator is not None and declarator.type == "identifier"
        is_named = is_named and not any(child.is_error for child in part.children)  # Else it is `state.x`.
        kind = part.child_by_field_name("type")
        is_type = declarator is None and kind is not None and kind.type == "primitive_type"
        if part.type != "parameter_declaration" or is_named or is_type:
            return False
    return parameters.named_child_count > 0


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
