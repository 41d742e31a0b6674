"""Edits that check the indexes of a document's own vectors, arrays and strings.

Those of the state check their own. The standard library's read, beyond their end, what happens to be there.
"""

import re
from collections.abc import Iterator

from aos_language.cpp.flow import STATES
from aos_language.cpp.snippets import Cpp, strip_comments

_OPENING = re.compile(r"\s*\[(?!\s*\{)")


def index_edits(cpp: Cpp) -> Iterator[tuple[int, int, str]]:
    """Replacements (start, end, text) by offsets: `row[i][k]` becomes `aos::at(aos::at(row, i), k)`.

    What may stand just behind the last element keeps its brackets, as `&row[9]`, and so does a map.
    """
    maps = {name.name for name in cpp.declarations if "map" in name.type}
    literals = {offset for literal in cpp.literals for offset in range(literal.start, literal.end)}
    text = "".join(" " if at in literals else letter for at, letter in enumerate(strip_comments(cpp.code)))
    for mention in cpp.mentions:
        start, at = mention.root.start, mention.root.end
        if mention.path[0] in STATES | maps or mention.path[1:2] != ("[]",):
            continue
        if text[:start].rstrip().endswith("&"):
            continue
        indexes = tuple(_indexes(text, at))
        if indexes:
            yield start, start, "aos::at(" * len(indexes)
        for opening, closing in indexes:
            yield opening, opening + 1, ", "
            yield closing, closing + 1, ")"


def _indexes(text: str, at: int) -> Iterator[tuple[int, int]]:
    """Yields where brackets follow one another from an offset on; `{1, 2}` is the key of a map."""
    while (found := _OPENING.match(text, at)) is not None:
        at, depth = found.end(), 1
        while depth:
            depth += (text[at] in "[({") - (text[at] in "])}")
            at += 1
        yield found.end() - 1, at - 1
