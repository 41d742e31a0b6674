"""Python snippets of documents, made ready to stand in a generated function.

Knows layout and names, not meaning: where each line came from, what a snippet reads, assigns and calls, and
whether it is Python at all. Nothing is run here.
"""

from __future__ import annotations

import ast
import io
import tokenize
import warnings
from typing import Literal

import msgspec
from msgspec.structs import replace

from aos_language.python_syntax import always_returns, module_of, names_bound_by, own_scope, tree_of
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Snippet

_TAB = "    "


class LineOrigin(msgspec.Struct, frozen=True):
    """The document place of one line of generated code.

    Column c of the generated line is column `c - shift` of line `line` of `snippet`; without a shift the
    whole line stands for the start of `snippet`.
    """

    snippet: Snippet
    line: int = 1
    shift: int | None = None

    @classmethod
    def of_span(cls, span: Span) -> LineOrigin:
        """The origin of a line that no snippet wrote, but that one element of the document made necessary."""
        return cls(Snippet("", (span,)))

    def locate(self, column: int) -> Span:
        """The document place of a column of the generated line, counted from 1."""
        return self.snippet.locate(self.line, 1 if self.shift is None else column - self.shift)

    def indented(self, width: int) -> LineOrigin:
        """The origin of the same line moved to the right."""
        return self if self.shift is None else replace(self, shift=self.shift + width)


class CodeLine(msgspec.Struct, frozen=True):
    """One line, without the indentation all lines share; an `is_fixed` one begins inside a text."""

    text: str
    origin: LineOrigin
    is_fixed: bool = False


class PythonCode(msgspec.Struct, frozen=True):
    """A snippet that is valid Python by itself.

    `reads`, `assigns` and `calls` are bare names. `returns` says whether control always, sometimes or never
    leaves by `return`; `is_plain` that an expression can stand anywhere without parentheses of its own,
    `is_true` that it is the word True.
    """

    lines: tuple[CodeLine, ...]
    reads: frozenset[str]
    assigns: frozenset[str]
    calls: frozenset[str]
    returns: Literal["always", "sometimes", "never"] = "never"
    is_plain: bool = False
    is_true: bool = False


def read_body(snippet: Snippet) -> PythonCode | Diagnostic:
    """Statements as they stand in a function body; a diagnostic AOS121 if they are not Python."""
    lines = _layout(snippet)
    tree = _parse("\n".join(line.text for line in lines), lines, snippet)
    if isinstance(tree, Diagnostic):
        return tree
    names = _Names(tree)
    if names.suspends:
        return _fault("`yield` and `await` have no meaning here", snippet.span)
    if always_returns(tree.body):
        returns: Literal["always", "sometimes", "never"] = "always"
    else:
        returns = "sometimes" if names.returns else "never"
    return PythonCode(lines, names.reads, names.assigns, names.calls, returns)


def read_expression(snippet: Snippet) -> PythonCode | Diagnostic:
    """One expression, over one line or several; a diagnostic AOS121 if it is not Python."""
    lines = _layout(snippet)
    if not lines:
        return _fault("an expression is missing", snippet.span)
    text = "\n".join(line.text for line in lines)
    tree = _parse(f"(\n{text}\n)", lines, snippet, lines_before=1)
    # What closes the first bracket and opens another passes in one kind of brackets only.
    other = _parse(f"[\n{text}\n]", lines, snippet, lines_before=1)
    for part in (tree, other):
        if isinstance(part, Diagnostic):
            return part
    assert isinstance(tree, ast.Module)
    if len(tree.body) != 1 or not isinstance(tree.body[0], ast.Expr):
        return _fault("one expression is expected", snippet.span)
    names = _Names(tree)
    if names.suspends:
        return _fault("`yield` and `await` have no meaning here", snippet.span)
    value = tree.body[0].value
    is_true = isinstance(value, ast.Constant) and value.value is True
    is_plain = _is_plain(text, value)
    return PythonCode(lines, names.reads, names.assigns, names.calls, is_plain=is_plain, is_true=is_true)


def python_fault(error: SyntaxError | ValueError | RecursionError | MemoryError, span: Span) -> Diagnostic:
    """The diagnostic AOS121 of what Python's compiler said about the code at `span`."""
    return _fault(error.msg if isinstance(error, SyntaxError) else str(error) or type(error).__name__, span)


def _fault(message: str, span: Span) -> Diagnostic:
    return Diagnostic(
        Severity.ERROR,
        "AOS121",
        f"this is not valid Python: {message}",
        span,
        "Abstraction mappings are written in Python 3",
    )


def _layout(snippet: Snippet) -> tuple[CodeLine, ...]:
    """The snippet's lines without the indentation they share and without empty lines around them.

    A tab at the start of a line counts four blanks, as the documents' language has it.
    """
    raw = [line.rstrip("\r").replace("\r", " ") for line in snippet.code.split("\n")]
    in_text = _lines_inside_texts("\n".join(raw))
    lines: list[tuple[int, str, int]] = []
    for number, line in enumerate(raw, start=1):
        if number in in_text:
            lines.append((number, line, 0))
            continue
        code = line.lstrip(" \t")
        blanks = line[: len(line) - len(code)].replace("\t", _TAB)
        lines.append((number, f"{blanks}{code}".rstrip(), len(blanks) + len(code) - len(line)))
    margin = _margin([line for number, line, _ in lines if number not in in_text])
    laid_out = []
    for number, line, shift in lines:
        is_fixed = number in in_text
        cut = 0 if is_fixed else min(margin, len(line) - len(line.lstrip(" ")))
        laid_out.append(CodeLine(line[cut:], LineOrigin(snippet, number, shift - cut), is_fixed))
    return _without_empty_ends(laid_out)


def _margin(lines: list[str]) -> int:
    widths = [len(line) - len(line.lstrip(" ")) for line in lines if line.strip() and line.lstrip()[0] != "#"]
    return min(widths, default=0)


def _without_empty_ends(lines: list[CodeLine]) -> tuple[CodeLine, ...]:
    filled = [index for index, line in enumerate(lines) if line.text.strip()]
    return tuple(lines[filled[0] : filled[-1] + 1]) if filled else ()


def _lines_inside_texts(code: str) -> frozenset[int]:
    """The numbers of the lines that begin inside a text literal, whose indentation is part of the text."""
    inside: set[int] = set()
    opened = getattr(tokenize, "FSTRING_START", -1)
    closed = getattr(tokenize, "FSTRING_END", -1)
    starts: list[int] = []
    try:
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            if token.type == opened:
                starts.append(token.start[0])
            elif token.type == closed:
                inside.update(range(starts.pop() + 1, token.end[0] + 1))
            elif token.type == tokenize.STRING:
                inside.update(range(token.start[0] + 1, token.end[0] + 1))
    except (tokenize.TokenError, SyntaxError):
        pass  # The parser says it better.
    return frozenset(inside)


def _parse(
    text: str, lines: tuple[CodeLine, ...], snippet: Snippet, *, lines_before: int = 0
) -> ast.Module | Diagnostic:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return module_of(text)
        except SyntaxError as error:
            index = (error.lineno or 1) - 1 - lines_before
            if not lines:
                return python_fault(error, snippet.span)
            line = lines[min(max(index, 0), len(lines) - 1)]
            return python_fault(error, line.origin.locate(error.offset or 1))
        except (ValueError, RecursionError, MemoryError) as error:
            return python_fault(error, snippet.span)


def _is_plain(text: str, value: ast.expr) -> bool:
    """Returns whether an expression reads the same as a condition or a dict's value without parentheses."""
    if isinstance(value, ast.Tuple | ast.NamedExpr | ast.Starred | ast.GeneratorExp):
        return False
    if "#" in text.rpartition("\n")[2]:
        return False
    try:
        tree_of(text, "eval")
    except SyntaxError:
        return False
    return True


class _Names:
    """The bare names of a snippet, and what they are used for."""

    def __init__(self, tree: ast.AST) -> None:
        read: set[str] = set()
        assigned: set[str] = set()
        called: set[str] = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Store):
                read.add(node.id)
            assigned.update(names_bound_by(node))
            if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                read.add(node.target.id)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                called.add(node.func.id)
        self.reads = frozenset(read)
        self.assigns = frozenset(assigned)
        self.calls = frozenset(called)
        own = list(own_scope(tree))
        self.returns = any(isinstance(node, ast.Return) for node in own)
        self.suspends = any(isinstance(node, ast.Yield | ast.YieldFrom | ast.Await) for node in own)
