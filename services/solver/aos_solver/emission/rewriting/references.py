"""Edits for references and pointers to parts of a state, which are const where the state is.

AOS 1.x gives special states a state that is not const, and documents write `int& level : state.levels`.
A reference that changes a const state does not compile all the same.

Also edits for lambdas that draw, whose source of draws is a variable of the emitted function, and for
elements that a document's own vectors, arrays and strings are asked for. Those of the state check their own,
but for iterators. The standard library's read, beyond their end, what happens to be there.
"""

import re
from collections.abc import Iterator
from itertools import groupby

from aos_language.cpp.facts import Element
from aos_language.cpp.keywords import DRAW_SOURCES, STATES
from aos_language.cpp.pointers import path_bound
from aos_language.cpp.snippets import Cpp, DeclarationKind, strip_comments

_TYPE = re.compile(r"(?:^|[;{}(])\s*([A-Za-z_][\w:]*(?:\s+[A-Za-z_][\w:]*)*)\s*[&*]\s*$")
_ELEMENT = re.compile(r"(?:\bfor\s*\(|\]\s*\((?:[^()]*,)?)\s*((?:auto|[A-Za-z_]\w*\s*\*)\s*&)$")
_NO_TYPE = re.compile(r"\b(?:auto|const|return|static)\b")


def reference_edits(cpp: Cpp) -> Iterator[tuple[int, int, str]]:
    """Replacements (start, end, text) by offsets.

    - `int& level = state.level` and `for (int& level : state.levels)` become `auto& level`
    - `int* level = &state.levels[0]` becomes `auto* level`
    - with `state.tCupObjects`, whose pointers are made on demand, `auto& cup` and `tCup*& cup` of a loop or a
      lambda become `auto&& cup`
    """
    has_objects = any(mention.path[-1].endswith("Objects") for mention in cpp.mentions)
    for declaration in cpp.declarations:
        before = cpp.code[: declaration.extent.start].rstrip()
        element = _ELEMENT.search(before) if has_objects and declaration.name not in STATES else None
        if element is not None:
            yield element.start(1), element.end(1), "auto&&"
            continue
        if declaration.kind is not DeclarationKind.VARIABLE or declaration.type[-1:] not in ("&", "*"):
            continue
        path = path_bound(cpp, declaration)
        if not path:
            continue
        if (found := _TYPE.search(before)) is not None and not _NO_TYPE.search(found[1]):
            yield found.start(1), found.end(1), "auto"


_INTRODUCER = re.compile(r"(?<![\w\])])\s*\[([^\[\]]*)\]\s*(?=[({]|mutable\b|->)")
_BY_REFERENCE = re.compile(r"\s*&\s*(?:,|$)")


def capture_edits(cpp: Cpp, drawing: frozenset[str]) -> Iterator[tuple[int, int, str]]:
    """Insertions (start, end, text) by offsets; `drawing` are the shared functions that draw.

    `[](double p) { return AOS.Bernoulli(p); }` becomes `[&AOS](double p) ...`, and `[=]` becomes `[=, &AOS]`.
    """
    code = strip_comments(cpp.code)
    drawn = [(m.extent.start, m.path[0]) for m in cpp.mentions if m.path[0] in DRAW_SOURCES]
    drawn += [(call.extent.start, "AOS") for call in cpp.calls if call.name[:1] and call.name[0] in drawing]
    for found in _INTRODUCER.finditer(code) if drawn else ():
        if _BY_REFERENCE.match(found[1]) or any(
            each.start <= found.start(1) < each.end for each in cpp.literals
        ):
            continue
        end = end_of_body(code, found.end())
        sources = sorted({name for at, name in drawn if found.end() <= at < end})
        sources = [name for name in sources if f"&{name}" not in found[1].replace(" ", "")]
        if sources:
            text = ", ".join(f"&{name}" for name in sources)
            yield found.end(1), found.end(1), f", {text}" if found[1].strip() else text


def end_of_body(code: str, start: int) -> int:
    """The end of the first block in braces behind a place."""
    depth = 0
    for at in range(code.find("{", start), len(code)):
        depth += {"{": 1, "}": -1}.get(code[at], 0)
        if depth == 0:
            return at
    return len(code)


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
