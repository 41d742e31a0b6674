"""Snippets cut to size: expressions without blanks and semicolons, Python without common indentation."""

from __future__ import annotations

from aos_protocol.documents import Snippet

__all__ = ["cut", "dedented", "expression", "without_blank_lines"]


def cut(snippet: Snippet, start: int, end: int) -> Snippet:
    """The part between two character offsets; at least an empty one at `start`."""
    before = snippet.code[:start]
    line = before.count("\n") + 1
    column = start - (before.rfind("\n") + 1) + 1
    code = snippet.code[start:end]
    last = line + code.count("\n")
    origins = (snippet.locate(line, column), *snippet.origins[line:last])
    escapes = []
    for at, index, width in snippet.escapes:
        shift = column - 1 if at == line else 0
        if line <= at <= last and index > shift:
            escapes.append((at - line + 1, index - shift, width))
    return Snippet(code, origins, tuple(escapes))


def expression(snippet: Snippet, *, drop_semicolon: bool = False) -> Snippet:
    """Without the blanks around it, and without a final semicolon."""
    code = snippet.code.rstrip()
    while drop_semicolon and code.endswith(";"):
        code = code[:-1].rstrip()
    start = len(code) - len(code.lstrip())
    return cut(snippet, start, len(code))


def without_blank_lines(snippet: Snippet) -> Snippet:
    """Without blank lines at the start and blanks at the end."""
    code = snippet.code.rstrip()
    lead = len(code) - len(code.lstrip())
    return cut(snippet, code.rfind("\n", 0, lead) + 1, len(code))


def dedented(snippet: Snippet) -> Snippet:
    """Without the indentation that all of its lines share, as Python wants it."""
    lines = snippet.code.split("\n")
    indents = [line[: len(line) - len(line.lstrip(" \t"))] for line in lines if line.strip()]
    common = indents[0] if indents else ""
    for indent in indents:
        while not indent.startswith(common):
            common = common[:-1]
    width = len(common)
    if not width:
        return snippet
    cut_lines = [line[width:] if line.strip() else "" for line in lines]
    origins = tuple(snippet.locate(number, width + 1) for number in range(1, len(lines) + 1))
    escapes = tuple((at, index - width, size) for at, index, size in snippet.escapes if index > width)
    return Snippet("\n".join(cut_lines), origins, escapes)
