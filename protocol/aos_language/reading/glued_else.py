"""An `else` that the next word is glued to, as in `elseif`: AOS 1.x puts a blank behind each `else`.

Only words that cannot be the end of a name are taken apart, so that `elsewhere` stays.
"""

import re
from collections.abc import Iterable

from msgspec.structs import replace

from aos_language.cpp.tokens import cut
from aos_language.findings import Findings
from aos_protocol.diagnostics import Mend
from aos_protocol.documents import Assignment, Iteration, Snippet, line_and_column

_GLUED = re.compile(
    r"\belse(state_{0,3}|if|for|while|switch|return|break|continue|AOS|AOSUtils|__[A-Za-z]\w*)\b"
)


def with_else_apart(block: Assignment, findings: Findings) -> Assignment:
    """The assignment in which each such word is two, as the warnings say."""
    return replace(
        block,
        code=_apart(block.code, findings),
        over_previous=_loops_apart(block.over_previous, findings),
        over_next=_loops_apart(block.over_next, findings),
    )


def _loops_apart(loops: Iterable[Iteration], findings: Findings) -> tuple[Iteration, ...]:
    return tuple(replace(loop, body=_apart(loop.body, findings)) for loop in loops)


def _apart(snippet: Snippet | None, findings: Findings) -> Snippet | None:
    if snippet is None or _GLUED.search(snippet.code) is None:
        return snippet
    tokens = cut(snippet.code)
    texts = (*tokens.comments, *tokens.literals)
    code, escapes = snippet.code, [*snippet.escapes]
    for found in reversed([*_GLUED.finditer(code)]):
        if any(text.start <= found.start() < text.end for text in texts):
            continue
        line, column = line_and_column(code, found.start(1))
        mend = Mend(snippet.locate(line, column), 0, " ")
        span, hint = snippet.locate(line, column - 4), f"It is read as `else {found[1]}`"
        findings.warning("AOS127", f"`{found[0]}` is no word of C++", span, hint, mend)
        code = f"{code[: found.start(1)]} {code[found.start(1) :]}"
        escapes = [(at, index + (at == line and index >= column), width) for at, index, width in escapes]
        escapes.append((line, column, 0))  # The blank takes no character of the document.
    return replace(snippet, code=code, escapes=tuple(escapes))
