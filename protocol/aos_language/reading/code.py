"""Snippets cut to size: expressions without blanks and semicolons, Python without common indentation."""

from aos_protocol.documents import Snippet


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
    """Returns the snippet without the blanks around it, and without a final semicolon if that is to be
    dropped."""
    code = snippet.code.rstrip()
    while drop_semicolon and code.endswith(";"):
        code = code[:-1].rstrip()
    start = len(code) - len(code.lstrip())
    return cut(snippet, start, len(code))


def guarded(condition: Snippet, code: Snippet) -> Snippet:
    """C++ statements that run only where a condition holds."""
    shift = len(condition.origins)
    escapes = [(line + 1, index, width) for line, index, width in condition.escapes]
    escapes += [(line + shift + 2, index, width) for line, index, width in code.escapes]
    origins = (condition.span, *condition.origins, code.span, *code.origins, code.span)
    return Snippet(f"if (\n{condition.code}\n) {{\n{code.code}\n}}", origins, tuple(escapes))


def joined(first: Snippet, second: Snippet) -> Snippet:
    """Returns both, the second one below the first."""
    shift = len(first.origins)
    escapes = [(line + shift, index, width) for line, index, width in second.escapes]
    code = f"{first.code}\n{second.code}"
    return Snippet(code, (*first.origins, *second.origins), (*first.escapes, *escapes))


def without_blank_lines(snippet: Snippet) -> Snippet:
    """Returns the snippet without blank lines at the start and blanks at the end."""
    code = snippet.code.rstrip()
    lead = len(code) - len(code.lstrip())
    return cut(snippet, code.rfind("\n", 0, lead) + 1, len(code))


def dedented(snippet: Snippet) -> Snippet:
    """Returns the snippet without the indentation that all of its lines of code share, as Python wants it."""
    lines = snippet.code.split("\n")
    indents = [line[: len(line) - len(line.lstrip(" \t"))] for line in lines]
    of_code = [indent for indent, line in zip(indents, lines, strict=True) if _is_code(line)]
    common = of_code[0] if of_code else ""
    for indent in of_code:
        while not indent.startswith(common):
            common = common[:-1]
    if not common:
        return snippet
    widths = [min(len(indent), len(common)) for indent in indents]
    cut_lines = [line[width:] if line.strip() else "" for line, width in zip(lines, widths, strict=True)]
    origins = tuple(snippet.locate(number, width + 1) for number, width in enumerate(widths, 1))
    escapes = [(at, index - widths[at - 1], size) for at, index, size in snippet.escapes]
    return Snippet("\n".join(cut_lines), origins, tuple(escape for escape in escapes if escape[1] > 0))


def _is_code(line: str) -> bool:
    """Returns whether a line of Python says anything; comments may be indented as they like."""
    return not line.lstrip(" \t").startswith("#") and not line.isspace() and line != ""
