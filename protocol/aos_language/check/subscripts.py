"""The contents of the brackets in an access path."""

import re
from collections.abc import Iterator

from aos_language.cpp.snippets import Extent, Mention

_NAME = re.compile(r"\s*([A-Za-z_]\w*)\s*")


def subscripts_of(mention: Mention, code: str) -> Iterator[Extent | None]:
    """Yields for each `[...]` of the path, in order, the place of its one name; None where it is no lone
    name."""
    depth = 0
    start = mention.extent.start
    for at in range(mention.extent.start, mention.extent.end):
        if code[at] == "[":
            depth += 1
            start = at + 1 if depth == 1 else start
        elif code[at] == "]":
            depth -= 1
            if depth == 0:
                match = _NAME.fullmatch(code, start, at)
                yield _extent(code, *match.span(1)) if match is not None else None


def _extent(code: str, start: int, end: int) -> Extent:
    return Extent(start, end, code.count("\n", 0, start) + 1, start - code.rfind("\n", 0, start))
