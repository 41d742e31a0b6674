"""Edits for references and pointers to parts of a state, which are const where the state is.

AOS 1.x gives special states a state that is not const, and documents write `int& level : state.levels`.
A reference that changes a const state does not compile all the same.
"""

import re
from collections.abc import Iterator

from aos_language.cpp.bound import path_bound
from aos_language.cpp.snippets import Cpp, DeclarationKind

_TYPE = re.compile(r"(?:^|[;{}(])\s*([A-Za-z_][\w:]*(?:\s+[A-Za-z_][\w:]*)*)\s*[&*]\s*$")
_NO_TYPE = re.compile(r"\b(?:auto|const|return|static)\b")


def reference_edits(cpp: Cpp) -> Iterator[tuple[int, int, str]]:
    """Replacements (start, end, text) by offsets.

    - `int& level = state.level` and `for (int& level : state.levels)` become `auto& level`
    - `int* level = &state.levels[0]` becomes `auto* level`
    - `for (auto& cup : state.tCupObjects)` becomes `auto&& cup`: the pointers are made on demand
    """
    for declaration in cpp.declarations:
        if declaration.kind is not DeclarationKind.VARIABLE or declaration.type[-1:] not in ("&", "*"):
            continue
        path = path_bound(cpp, declaration)
        if not path:
            continue
        before = cpp.code[: declaration.extent.start].rstrip()
        if declaration.initial is None and declaration.type == "auto&" and path[-1].endswith("Objects"):
            yield len(before), len(before), "&"
        elif (found := _TYPE.search(before)) is not None and not _NO_TYPE.search(found[1]):
            yield found.start(1), found.end(1), "auto"
