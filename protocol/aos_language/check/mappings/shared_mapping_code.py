"""The Python that all mappings of a project share: does it parse, keep nothing, and is it used?"""

import ast
from collections.abc import Iterable, Iterator

from aos_language.check.mappings.mapping_code import snippets_of_mapping
from aos_language.check.mappings.python_names import PythonNames, check_names, top_level_names
from aos_language.check.mappings.python_parsed import parsed
from aos_language.check.scope import Scope
from aos_language.findings import Findings
from aos_language.local_types import RESERVED_LOCAL_NAMES
from aos_language.python_syntax import module_of, place_in
from aos_protocol.documents import AbstractionMapping, Snippet

_CHANGING = frozenset({
    "add", "append", "clear", "discard", "extend", "insert", "pop", "popitem", "remove", "reverse",
    "setdefault", "sort", "update",
})  # fmt: skip


def check_shared_mapping_code(
    snippet: Snippet, mappings: Iterable[AbstractionMapping], scope: Scope, findings: Findings
) -> None:
    """Reports AOS121 for what is no Python or keeps something, AOS110 for unknown names, AOS133 for unused
    ones."""
    tree = parsed(snippet, "exec", findings)
    if not isinstance(tree, ast.Module):
        return
    mappings = tuple(mappings)
    check_names(snippet, tree, PythonNames.of_constants(mappings, scope), findings)
    names = top_level_names(tree)
    for node, message in _keeping(tree, names):
        span = place_in(snippet, node)
        findings.error("AOS121", message, span, "Each activation begins anew: pass it on, and give it back")
    used = {name for mapping in mappings for name in _words(mapping)}
    for statement in tree.body:
        for name in sorted(top_level_names(ast.Module([statement], []))):
            span = place_in(snippet, statement)
            if name in RESERVED_LOCAL_NAMES:
                message = f"`{name}` means something else in a mapping"
                findings.error("AOS126", message, span, "Choose another name")
            # A name that is misspelt where it is used would be told twice.
            elif not (findings.has_errors or isinstance(statement, ast.Import | ast.ImportFrom)) and not (
                name in used or any(_mentions(other, name) for other in tree.body if other is not statement)
            ):
                findings.warning(
                    "AOS133", f"no mapping uses the shared {name}", span, "Leave it out, or use it"
                )


def _keeping(tree: ast.Module, names: frozenset[str]) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """Yields the places where a function changes what all activations would share, and what is wrong with
    each."""
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            continue
        for node in ast.walk(function):
            match node:
                case ast.Global(names=several):
                    yield node, f"`global {', '.join(several)}` would reach the next activation"
                case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr=method)) if (
                    name in names and method in _CHANGING
                ):
                    yield node, f"`{name}.{method}` would reach the next activation"
                case (
                    ast.Subscript(value=ast.Name(id=name), ctx=ast.Store() | ast.Del())
                    | ast.Attribute(value=ast.Name(id=name), ctx=ast.Store() | ast.Del())
                ) if name in names:
                    yield node, f"a change of `{name}` would reach the next activation"


def _words(mapping: AbstractionMapping) -> Iterator[str]:
    for snippet in snippets_of_mapping(mapping):
        try:
            tree = module_of(f"(\n{snippet.code}\n)")
        except SyntaxError:
            tree = _parsed_or_empty(snippet.code)
        yield from (node.id for node in ast.walk(tree) if isinstance(node, ast.Name))


def _parsed_or_empty(code: str) -> ast.Module:
    try:
        return module_of(code)
    except (SyntaxError, ValueError):
        return ast.Module([], [])  # Told where the mapping is checked.


def _mentions(statement: ast.stmt, name: str) -> bool:
    return any(isinstance(node, ast.Name) and node.id == name for node in ast.walk(statement))
