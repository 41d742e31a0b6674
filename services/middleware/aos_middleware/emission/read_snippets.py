"""The documents' Python of one mapping as it is read for its module: code, mistakes, and marked lines."""

from collections.abc import Iterable

from aos_middleware.emission.generated_lines import MarkedLines
from aos_middleware.emission.python_code import PythonCode, read_body, read_expression
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import AbstractionMapping, LocalSource, LocalVariable, Snippet


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
