"""C++ text as a syntax tree: the only door to the parser of tree-sitter."""

import time

import tree_sitter
import tree_sitter_cpp

MAX_CPU_S = 2.0
"""A text that is far from C++ takes the parser time that grows faster than the text."""
_SHORT_BYTES = 10_000
_PIECE_BYTES = 65536
_PARSER = tree_sitter.Parser(tree_sitter.Language(tree_sitter_cpp.language()))


def tree_of(text: str) -> tree_sitter.Node:
    """The root of the tree of any text; places in it count bytes of UTF-8."""
    return _PARSER.parse(text.encode("utf-8", "replace")).root_node


def tree_soon(text: str) -> tree_sitter.Node | None:
    """The same; None where that takes more than `MAX_CPU_S` of processor time."""
    data = text.encode("utf-8", "replace")
    if len(data) <= _SHORT_BYTES:
        return _PARSER.parse(data).root_node
    started_s = time.thread_time()

    def is_over(*_: object) -> bool:
        return time.thread_time() - started_s > MAX_CPU_S

    try:
        return _PARSER.parse(
            lambda offset, _: data[offset : offset + _PIECE_BYTES], progress_callback=is_over
        ).root_node
    except ValueError:
        _PARSER.reset()
        return None
