"""Slips of Python in mappings: code that runs and does other than it seems to say."""

import ast
import re
from collections.abc import Collection, Iterator

Slip = tuple[ast.expr, str, str]
"""The place, the message and the hint."""

_OF_TEXTS = frozenset({"lower", "lstrip", "replace", "rstrip", "split", "splitlines", "strip", "upper"})
_GIVING = frozenset({"abs", "max", "min", "round", "sorted", "str", "sum"})
_GIVING_NONE = frozenset({"append", "extend", "reverse", "sort"})
_FILLING = frozenset({"format", "format_map", "replace", "sub"})
_FIELD = re.compile(r"\{(\w+)[^{}]*\}")


def python_slips(tree: ast.AST, variables: Collection[str]) -> Iterator[Slip]:
    """Yields the slips in the code of a mapping that has these local variables."""
    nodes = list(ast.walk(tree))
    names = {node.id for node in nodes if isinstance(node, ast.Name)} | {*variables, "__input"}
    fills_in = any(isinstance(node, ast.Attribute) and node.attr in _FILLING for node in nodes)
    for node in nodes:
        yield from _slip(node)
        if not fills_in and not isinstance(node, ast.JoinedStr | ast.Expr):
            yield from _without_f(node, names)


def _slip(node: ast.AST) -> Iterator[Slip]:
    match node:
        case ast.Compare(left=left, ops=[ast.Is() | ast.IsNot()], comparators=[ast.Constant(value=value)]):
            if isinstance(value, str | int | float) and not isinstance(value, bool):
                yield left, f"`is` asks whether this is the very object {value!r}", "Write `==` or `!=`"
        case ast.Assign(value=ast.Call(func=ast.Attribute(attr=name)) as call) if name in _GIVING_NONE:
            yield call, f"`{name}` changes the list and gives None", "Call it in a line of its own"
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=whole, attr=name)) as call):
            taker = whole.id if isinstance(whole, ast.Name) else "NAME"
            if name in _OF_TEXTS and taker != "os":
                yield call, f"nothing takes what `{name}` gives", f"Write `{taker} = {ast.unparse(call)}`"
        case ast.Expr(value=ast.Call(func=ast.Name(id=name)) as call) if name in _GIVING:
            yield call, f"nothing takes what `{name}` gives", f"Write `NAME = {ast.unparse(call)}`"
        case ast.BinOp(op=ast.BitXor(), left=left, right=ast.Constant(value=2 | 3 as power)):
            yield node, "`^` is no power in Python", f"Write `{ast.unparse(left)} ** {power}`"


def _without_f(node: ast.AST, names: Collection[str]) -> Iterator[Slip]:
    """Yields texts right below a node, but for those of an f-string and for comments."""
    for text in ast.iter_child_nodes(node):
        if isinstance(text, ast.Constant) and isinstance(text.value, str):
            field = _FIELD.search(text.value)
            if field is not None and field[1] in names:
                yield text, f"`{field[0]}` is text here, and no value", "Write an `f` before the quote"
