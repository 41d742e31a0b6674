"""C++ text as a syntax tree: the only door to the parser of tree-sitter."""

from __future__ import annotations

import tree_sitter
import tree_sitter_cpp

__all__ = ["tree_of"]

_PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_cpp.language()))


def tree_of(text: str) -> tree_sitter.Node:
    """The root of the tree of any text; places in it count bytes of UTF-8."""
    return _PARSER.parse(text.encode("utf-8", "replace")).root_node
