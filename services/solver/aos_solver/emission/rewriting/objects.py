"""Edits for pointers and references to the objects of a state.

What `state.<Type>Objects` points at is const where its state is; documents write `tCup*` for it everywhere.
"""

import re
from collections.abc import Iterator

from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Access, Cpp, Declaration, DeclarationKind, Extent, strip_comments

_POINTER = re.compile(r"(\bconst\s+)?\b([A-Za-z_]\w*)\s*\*\s*$")
_REFERENCE = re.compile(r"(\bconst\s+)?\b([A-Za-z_]\w*)\s*&\s*$")
_NO_OBJECT = frozenset({"", "0", "NULL", "nullptr", "{}", "{nullptr}"})
_ALWAYS_WRITTEN = "state__"


def object_edits(cpp: Cpp, object_types: frozenset[str]) -> Iterator[tuple[int, int, str]]:
    """Replacements (start, end, text) by offsets.

    - `tCup* cup = state.tCupObjects[0]` and a lambda's `tCup* cup` become `auto* cup`
    - `tCup* best = NULL` becomes `aos::Pointer<tCup, decltype(state)> best`, of the copy that it is set from
    - `tCup* cups[2] = {...}` becomes an array of such pointers
    - `vector<tCup*> cups` becomes `vector<aos::Pointer<tCup, decltype(state)>> cups` in the same way
    - `tCup& cup = *state.tCupObjects[0]` becomes `auto& cup`
    - `auto cups = state.tCupObjects` becomes a vector, which may be sorted, and `auto& cups` `auto&& cups`
    """
    if not object_types:
        return
    for declaration in cpp.declarations:
        before = cpp.code[: declaration.extent.start]
        pointer, reference = _POINTER.search(before), _REFERENCE.search(before)
        initial = declaration.initial
        if pointer is not None and pointer[2] in object_types and not pointer[1]:
            copy = _copy_set_from(cpp, declaration, pointer[2])
            if not _names_its_copy(cpp, declaration):
                yield pointer.start(2), pointer.end(2), "auto"
            elif copy:
                yield pointer.start(2), len(before.rstrip()), f"aos::Pointer<{pointer[2]}, decltype({copy})>"
        elif reference is not None and reference[2] in object_types and not reference[1]:
            is_object = initial is not None and bool(_copies_in(cpp, reference[2], initial))
            yield from [(reference.start(2), reference.end(2), "auto")] if is_object else []
        elif initial is None or not _is_list(cpp, initial, object_types):
            continue
        elif declaration.type == "auto":
            yield initial.start, initial.start, "aos::listed("
            yield initial.end, initial.end, ")"
        elif declaration.type == "auto&":  # The list is a value, which `auto&&` takes.
            yield declaration.extent.start, declaration.extent.start, "&"
    yield from _within_types(cpp, object_types)


def _within_types(cpp: Cpp, object_types: frozenset[str]) -> Iterator[tuple[int, int, str]]:
    """Pointers among the arguments of a template or a function's type, and as what a lambda returns."""
    code = strip_comments(cpp.code)
    for name in sorted(object_types):
        pattern = rf"(?<!const )\b{name}\s*\*(?=\s*[,>)])|(?<=->){name}\s*\*|(?<=-> ){name}\s*\*"
        for found in re.finditer(pattern, code):
            declared = next((d for d in cpp.declarations if d.extent.start > found.start()), None)
            is_of_it = declared is not None and ";" not in code[found.start() : declared.extent.start]
            initial = declared.initial if declared is not None and is_of_it else None
            copies = set[str]() if initial is None else _copies_in(cpp, name, initial)
            copies = copies or _copies_in(cpp, name) - {_ALWAYS_WRITTEN}
            is_literal = any(literal.start <= found.start() < literal.end for literal in cpp.literals)
            if len(copies) == 1 and _ALWAYS_WRITTEN not in copies and not is_literal:
                yield found.start(), found.end(), f"aos::Pointer<{name}, decltype({min(copies)})>"


def _is_list(cpp: Cpp, initial: Extent, object_types: frozenset[str]) -> bool:
    """Returns whether a variable starts as a list of objects, and not as one of them."""
    lists = {f"{name}Objects" for name in object_types}
    return any(
        mention.extent == initial and mention.path[0] in STATES and mention.path[1] in lists
        for mention in cpp.mentions
        if len(mention.path) == 2
    )


def _names_its_copy(cpp: Cpp, declaration: Declaration) -> bool:
    """Returns whether a pointer has no type to take over: one without an object, or one of an array."""
    if declaration.kind is not DeclarationKind.VARIABLE:
        return False
    initial, after = declaration.initial, cpp.code[declaration.extent.end :].lstrip()
    if initial is None or after.startswith("["):
        return not after.startswith(":")  # Else it is of a loop.
    return cpp.text(initial).strip() in _NO_OBJECT


def _copy_set_from(cpp: Cpp, declaration: Declaration, type_name: str) -> str:
    """The copy of the state whose objects a pointer is set to; empty where `tCup*` is right already."""
    initial = [] if declaration.initial is None else [declaration.initial]
    assigned = [m.assigned for m in cpp.mentions if m.path == (declaration.name,) and m.assigned is not None]
    direct = {copy for extent in initial + assigned for copy in _copies_in(cpp, type_name, extent)}
    copies = direct or _copies_in(cpp, type_name)
    return min(copies) if len(copies) == 1 and _ALWAYS_WRITTEN not in copies else ""


def _copies_in(cpp: Cpp, type_name: str, extent: Extent | None = None) -> set[str]:
    """The copies of the state whose objects are mentioned anywhere in the code, or pointed at in a part."""
    return {
        mention.path[0]
        for mention in cpp.mentions
        if mention.path[0] in STATES
        and (extent is None or extent.start <= mention.extent.start < extent.end)
        and (
            mention.path[1:2] == (f"{type_name}Objects",)
            or (extent is not None and mention.access is Access.BIND)
        )
    }
