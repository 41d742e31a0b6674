"""The parts of a state that references and pointers of the code stand for."""

import re
from collections import Counter

from aos_language.cpp.facts import Access, Cpp, Declaration, DeclarationKind, Mention
from aos_language.cpp.flow import STATES

_LOOP_COLON = re.compile(r"\s*:\s*")


def path_bound(cpp: Cpp, declaration: Declaration) -> tuple[str, ...]:
    """Returns the path of the state that a reference or pointer, or that of a loop, is bound to; empty for others."""
    initial = declaration.initial
    loop = _LOOP_COLON.match(cpp.code, declaration.extent.end) if initial is None else None
    start = initial.start if initial is not None else loop.end() if loop is not None else None
    if start is not None and initial is not None and declaration.type.endswith("*"):
        start = start + 1 if cpp.code.startswith("&", start) else None
    paths = (m.path for m in cpp.mentions if m.extent.start == start and m.path[0] in STATES and not m.method)
    return next(paths, ())


def bound_paths(cpp: Cpp) -> dict[str, tuple[str, ...]]:
    """Returns what each name stands for that is declared once, as a reference or pointer, and not const."""
    names = Counter(declaration.name for declaration in cpp.declarations)
    places = [
        declaration
        for declaration in cpp.declarations
        if declaration.kind is DeclarationKind.VARIABLE and names[declaration.name] == 1
        if declaration.type[-1:] in ("&", "*") and not declaration.type.startswith("const")
    ]
    return {place.name: path for place in places if (path := path_bound(cpp, place))}


def changes_bound(cpp: Cpp, mention: Mention) -> bool:
    """Returns whether a mention of such a name changes what it stands for, and not only a pointer."""
    if mention.access not in (Access.WRITE, Access.UPDATE):
        return False
    own = next(each for each in cpp.declarations if each.name == mention.path[0])
    if own.type.endswith("&"):
        return True
    is_moved = any(m.path == (own.name,) and m.access is not Access.READ for m in cpp.mentions)
    return len(mention.path) > 1 and not is_moved
