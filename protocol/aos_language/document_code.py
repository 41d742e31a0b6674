"""The code of a document's section, snippet by snippet, as it is read."""

import re
from collections.abc import Collection, Iterable, Iterator

from aos_language.cpp.shared import NO_SHARED_CODE, SharedCode, shared_code
from aos_language.cpp.snippets import Cpp, read_cpp, read_cpp_expression
from aos_protocol.documents import Assignment, Environment, Snippet

_COMPARED = re.compile(r"\s*[!=]=\s*(?:NULL|nullptr)\b")
_PARAMETER = re.compile(r"\s*->")
_COMPARED_BEFORE = re.compile(r"(?:NULL|nullptr)\s*[!=]=\s*$")


def absent_skills(cpp: Cpp, known: Collection[str]) -> frozenset[str]:
    """The names that extrinsic code takes for skills and that are not `known`: it compares them with NULL, or
    reads their parameters."""
    own = cpp.declared
    return frozenset(
        mention.path[0]
        for mention in cpp.mentions
        if mention.path[0] not in own
        and mention.path[0] not in known
        and (
            _PARAMETER.match(cpp.code, mention.root.end)
            if len(mention.path) > 1
            else _COMPARED.match(cpp.code, mention.extent.end)
            or _COMPARED_BEFORE.search(cpp.code, 0, mention.extent.start)
        )
    )


def shared_code_of(environment: Environment) -> SharedCode:
    if environment.shared_code is None:
        return NO_SHARED_CODE
    compounds = frozenset(compound.name for compound in environment.compounds)
    return shared_code(environment.shared_code.code, compounds)


def snippets_of(assignments: Iterable[Assignment]) -> Iterator[tuple[Snippet, Cpp]]:
    """Every snippet of a section, read."""
    for assignment in assignments:
        for loop in (*assignment.over_previous, *assignment.over_next):
            if loop.condition is not None:
                yield loop.condition, read_cpp_expression(loop.condition.code)
            if loop.body is not None:
                yield loop.body, read_cpp(loop.body.code)
        if assignment.code is not None:
            yield assignment.code, read_cpp(assignment.code.code)
