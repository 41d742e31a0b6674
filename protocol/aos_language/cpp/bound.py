"""The parts of a state that references and pointers of the code stand for."""

import re
from collections import Counter

from aos_language.cpp.facts import Access, Cpp, Declaration, Mention
from aos_language.cpp.keywords import STATES

_LOOP_COLON = re.compile(r"\s*:\s*")


def path_bound(cpp: Cpp, declaration: Declaration) -> tuple[str, ...]:
    """Returns the path of the state that a reference or pointer is bound to, also in a loop; else nothing."""
    initial = declaration.initial
    loop = _LOOP_COLON.match(cpp.code, declaration.extent.end) if initial is None else None
    start = initial.start if initial is not None else loop.end() if loop is not None else None
    if start is not None and initial is not None and declaration.type.endswith("*"):
        start = start + 1 if cpp.code.startswith("&", start) else None
    begun = (m for m in cpp.mentions if m.extent.start == start and m.path[0] in STATES and not m.method)
    return next((m.path for m in begun if initial is None or m.extent.end == initial.end), ())


def bound_paths(cpp: Cpp) -> dict[str, tuple[str, ...]]:
    """Returns what each reference or pointer stands for that is declared once and is not const."""
    names = Counter(declaration.name for declaration in cpp.declarations)
    return {
        place.name: path
        for place in cpp.declarations
        if names[place.name] == 1 and re.fullmatch(r"(?!const).*[&*]", place.type)
        if (path := path_bound(cpp, place))
    }


def changes_bound(cpp: Cpp, mention: Mention) -> bool:
    """Returns whether a mention of such a name changes what it stands for, and not only a pointer."""
    if mention.access not in (Access.WRITE, Access.UPDATE):
        return False
    own = next(each for each in cpp.declarations if each.name == mention.path[0])
    if own.type.endswith("&"):
        return True
    is_moved = any(m.path == (own.name,) and m.access is not Access.READ for m in cpp.mentions)
    return len(mention.path) > 1 and not is_moved
