"""Python's own parser, one thread at a time."""

import ast
import threading

_ONE_AT_A_TIME = threading.Lock()
"""CPython 3.11 counts the depth of all threads together: where a finalizer lets another thread parse in the
middle of a parse, it raises SystemError (seen with 3.11.2 and 3.11.7; its issue 106905)."""


def module_of(text: str) -> ast.Module:
    """The syntax tree of statements; errors are those of `ast.parse`."""
    with _ONE_AT_A_TIME:
        return ast.parse(text)


def tree_of(text: str, mode: str) -> ast.AST:
    """The syntax tree of statements ("exec") or an expression ("eval"); errors are those of `ast.parse`."""
    with _ONE_AT_A_TIME:
        return ast.parse(text, mode=mode)
