"""Edits that check the elements which a document's own vectors, arrays and strings are asked for.

Those of the state check their own, but for iterators. The standard library's read, beyond their end, what
happens to be there.
"""

from collections.abc import Iterator
from itertools import groupby

from aos_language.cpp.facts import Element
from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Cpp


def index_edits(cpp: Cpp) -> Iterator[tuple[int, int, str]]:
    """Replacements (start, end, text) by offsets.

    - `row[i][k]` becomes `aos::at(aos::at(row, i), k)`
    - `row.back()`, `row.front()`, `row.pop_back()` and their like become `aos::filled(row).back()`
    - `*row.begin()` becomes `*aos::filled(row).begin()`
    """
    own = [element for element in cpp.elements if element.root not in STATES]
    own.sort(key=lambda element: (element.container.start, -element.container.end))
    for start, outermost_first in groupby(own, key=lambda element: element.container.start):
        elements = list(outermost_first)
        yield (
            start,
            start,
            "".join("aos::at(" if element.brackets else "aos::filled(" for element in elements),
        )
        for element in elements:
            yield from _closed(element)


def _closed(element: Element) -> Iterator[tuple[int, int, str]]:
    if element.brackets is None:
        yield element.container.end, element.container.end, ")"
        return
    opening, closing = element.brackets.start, element.brackets.end - 1
    yield opening, opening + 1, ", "
    yield closing, closing + 1, ")"
