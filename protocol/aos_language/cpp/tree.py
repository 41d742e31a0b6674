"""C++ text as a syntax tree: the only door to the parser of tree-sitter."""

import re
import time
from functools import cache

import tree_sitter
import tree_sitter_cpp
from tree_sitter import Node

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
