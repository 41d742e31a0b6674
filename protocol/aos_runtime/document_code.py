"""The code of a document's section, snippet by snippet, as it is read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from aos_protocol.documents import Assignment, Snippet
from aos_runtime.snippets import Cpp, read_cpp, read_cpp_expression

__all__ = ["snippets_of"]


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
