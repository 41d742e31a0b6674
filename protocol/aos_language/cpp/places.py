"""Places of a syntax tree in the text of a snippet: the tree counts bytes, and reads what is around it."""

from bisect import bisect_left
from collections.abc import Sequence

from tree_sitter import Node

from aos_language.cpp.tokens import Extent, Lines


class Places:
    """Places in `code`, of a tree of `complete`, the code with its missing semicolons and what surrounds it.

    `prefix` is how many characters stand before the code.
    """

    def __init__(self, code: str, complete: str, prefix: int, missing_semicolons: Sequence[int]) -> None:
        self._length = len(code)
        self._prefix = prefix
        self._lines = Lines(code)
        self._offsets = _character_offsets(complete)
        self._inserted = [at + index for index, at in enumerate(missing_semicolons)]

    def extent(self, node: Node) -> Extent:
        """Returns where a node stands; what is around the code has a place without length."""
        start, end = (self._offset(byte) for byte in (node.start_byte, node.end_byte))
        return self._lines.extent(start, end)

    def _offset(self, byte: int) -> int:
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
