"""Lines of a generated module that remember their document place, and the Python of one mapping as lines.

A template decides how the module looks; each line it places carries an invisible mark, and the marks are
taken out again after rendering. No line count is kept by hand, and no document text becomes template source.
"""

import re
from collections.abc import Iterable

from msgspec.structs import replace

from aos_middleware.emission.python_code import LineOrigin, PythonCode, read_body, read_expression
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import AbstractionMapping, LocalSource, LocalVariable, Snippet

_MARK = re.compile("\x00(\\d+)\x00")
_INDENT = " " * 4


class MarkedLines:
    """Makes marked lines, and finds them in the rendered text."""

    def __init__(self) -> None:
        self._origins: list[LineOrigin] = []

    def line(self, text: str, origin: LineOrigin) -> str:
        self._origins.append(origin)
        return f"\x00{len(self._origins) - 1}\x00{text}"

    def body(self, code: PythonCode, depth: int) -> list[str]:
        """Statements, `depth` levels deep; the lines that begin inside a text keep their indentation."""
        return [
            self.line(line.text, line.origin)
            if line.is_fixed
            else self.line(_indented(line.text, depth), line.origin.indented(depth * len(_INDENT)))
            for line in code.lines
        ]

    def expression(self, before: str, code: PythonCode, after: str, depth: int) -> list[str]:
        """An expression between two pieces of generated text, in parentheses where it needs them."""
        if not code.is_plain:
            origin = code.lines[0].origin
            return [
                self.line(_indented(f"{before}(", depth), origin),
                *self.body(code, depth + 1),
                self.line(_indented(f"){after}", depth), origin),
            ]
        first = code.lines[0]
        start = _indented(before, depth)
        rest = replace(code, lines=code.lines[1:])
        lines = [
            self.line(f"{start}{first.text}", first.origin.indented(len(start))),
            *self.body(rest, depth),
        ]
        return [*lines[:-1], f"{lines[-1]}{after}"]

    def separate(self, rendered: str) -> tuple[str, tuple[LineOrigin | None, ...]]:
        """The text without marks, and for each of its lines where it came from."""
        origins = []
        for line in rendered.split("\n"):
            mark = _MARK.search(line)
            origins.append(self._origins[int(mark[1])] if mark else None)
        return _MARK.sub("", rendered), tuple(origins)


def literal(text: str) -> str:
    if text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    return repr(text)


def word(text: str) -> str:
    """A document's text inside a comment or a docstring: what could end either gives way to `?`."""
    return re.sub(r"[^\w./ -]", "?", text.strip())


def _indented(text: str, depth: int) -> str:
    return f"{_INDENT * depth}{text}" if text else ""


class ReadSnippets:
    """Reads a mapping's snippets; its mistakes are collected in `diagnostics`.

    `codes` are all that were read, and `marks` the lines that lead back to the documents.
    """

    def __init__(self, mapping: AbstractionMapping) -> None:
        self.diagnostics: list[Diagnostic] = []
        self.marks = MarkedLines()
        self.codes: list[PythonCode] = []
        self.variables = {variable.name: variable for variable in mapping.local_variables}

    def expression(self, snippet: Snippet) -> PythonCode | None:
        """The expression; None where it is a mistake, which is kept."""
        return self._kept(read_expression(snippet))

    def body(self, snippet: Snippet) -> PythonCode | None:
        """The statements; None where they are a mistake, which is kept."""
        return self._kept(read_body(snippet))

    def mistake(self, code: str, message: str, span: Span) -> None:
        """Keeps a mistake of the documents."""
        self.diagnostics.append(Diagnostic(Severity.ERROR, code, message, span))

    def read_by(self, codes: Iterable[PythonCode], also: Iterable[str] = ()) -> list[str]:
        """The local variables that code reads, in the document's order."""
        read = {*also, *(name for code in codes for name in code.reads)}
        return [name for name in self.variables if name in read]

    def _kept(self, code: PythonCode | Diagnostic) -> PythonCode | None:
        if isinstance(code, Diagnostic):
            self.diagnostics.append(code)
            return None
        self.codes.append(code)
        return code


def function_name(variable: LocalVariable) -> str:
    """The name of the function that gives a local variable its value during an activation."""
    return f"{variable.name}_from_{'topic' if variable.source is LocalSource.TOPIC else 'response'}"
