"""Edits for references and pointers to parts of a state, which are const where the state is.

AOS 1.x gives special states a state that is not const, and documents write `int& level : state.levels`.
A reference that changes a const state does not compile all the same.
"""

import re
from collections.abc import Iterator

from aos_language.cpp.bound import path_bound
from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Cpp, DeclarationKind

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
