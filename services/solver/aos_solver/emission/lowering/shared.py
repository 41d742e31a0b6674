"""The reads in calls of shared functions: functions that only read may be looked through."""

from aos_language.cpp.keywords import STATES
from aos_language.cpp.shared import SharedCode, SharedFunction
from aos_language.cpp.snippets import Cpp, Extent


def looked_through(cpp: Cpp, shared: SharedCode) -> str:
    """The code with the whole state, as an argument of a function that only reads, replaced by what it reads.

    `holds(state, item)` becomes `holds((state.at + state.size), item)`: for readings of the text alone.
    """
    own = {declaration.name for declaration in cpp.declarations}
    edits: dict[Extent, str] = {}
    for call in cpp.calls:
        functions = [
            function
            for function in shared.functions
            if call.name == (function.name,) and function.name not in own
        ]
        for index, argument in enumerate(call.arguments if functions else ()):
            state = cpp.text(argument)
            read = [
                _members(function, index, shared) for function in functions if function.name in shared.reading
            ]
            if state in STATES and len(read) == len(functions) and None not in read:
                names = sorted(set().union(*(members or () for members in read)))
                edits[argument] = f"({' + '.join(f'{state}.{name}' for name in names) or '0'})"
    return cpp.replace(edits.items()) if edits else cpp.code


def _members(function: SharedFunction, index: int, shared: SharedCode) -> set[str] | None:
    """The members of a parameter that the function uses; None where it uses the parameter as a whole."""
    name = function.takes[index] if index < len(function.takes) else ""
    declared = {declaration.extent.start for declaration in shared.cpp.declarations}
    uses = [
        mention
        for mention in shared.cpp.mentions
        if mention.path[0] == name
        and function.extent.start <= mention.extent.start < function.extent.end
        and mention.root.start not in declared
    ]
    if not name or any(len(mention.path) == 1 for mention in uses):
        return None
    return {mention.path[1] for mention in uses}
