"""Python's own parser, one thread at a time, what code binds in its own scope, and where it stands."""

import ast
import threading
from collections.abc import Iterator

from aos_protocol.diagnostics import Span
from aos_protocol.documents import Snippet
from aos_protocol.spelling import column_of

_ONE_AT_A_TIME = threading.Lock()
"""CPython 3.11 counts the depth of all threads together: where a finalizer lets another thread parse in the
middle of a parse, it raises SystemError (seen with 3.11.2 and 3.11.7; its issue 106905)."""

_OWN_SCOPES = (
    ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Lambda
    | ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
)  # fmt: skip


def module_of(text: str) -> ast.Module:
    """The syntax tree of statements; errors are those of `ast.parse`."""
    with _ONE_AT_A_TIME:
        return ast.parse(text)


def tree_of(text: str, mode: str) -> ast.AST:
    """The syntax tree of statements ("exec") or an expression ("eval"); errors are those of `ast.parse`."""
    with _ONE_AT_A_TIME:
        return ast.parse(text, mode=mode)


def place_in(snippet: Snippet, node: ast.expr | ast.stmt | ast.excepthandler) -> Span:
    """The document place of a node of the snippet's tree."""
    return place_of_byte(snippet, node.lineno, node.col_offset)


def place_of_byte(snippet: Snippet, line: int, byte_offset: int) -> Span:
    return snippet.locate(line, column_of(snippet.code.split("\n")[line - 1], byte_offset))


def own_scope(tree: ast.AST) -> Iterator[ast.AST]:
    """The nodes of code that are not inside a function, a class or a comprehension of its own."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        if node is tree or not isinstance(node, _OWN_SCOPES):
            waiting += ast.iter_child_nodes(node)


def names_bound_by(node: ast.AST) -> tuple[str, ...]:
    """The names that one node of code binds by itself, in whatever scope."""
    match node:
        case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
            return (name,)
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
            return (name,)
        case ast.alias(name=name, asname=alias):
            return (alias or name.partition(".")[0],)
        case ast.MatchAs(name=str(name)) | ast.MatchStar(name=str(name)) | ast.MatchMapping(rest=str(name)):
            return (name,)
        case _:
            return ()


def always_returns(statements: list[ast.stmt]) -> bool:
    """Returns whether control leaves statements by `return` or `raise`, and never at their end."""
    if not statements:
        return False
    match statements[-1]:
        case ast.Return() | ast.Raise():
            return True
        case ast.If(body=body, orelse=orelse):
            return always_returns(body) and always_returns(orelse)
        case ast.Try(body=body, handlers=handlers, orelse=orelse, finalbody=final):
            return always_returns(final) or (
                always_returns(orelse or body) and all(always_returns(handler.body) for handler in handlers)
            )
        case _:
            return False
