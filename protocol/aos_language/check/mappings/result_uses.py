"""Local variables that are read where they have no value yet, or that their own code leaves without one, and
fields of results and messages that code takes by brackets: they are attributes."""

import ast

from aos_language.check.mappings.python_names import nodes_read
from aos_language.findings import Findings
from aos_language.python_syntax import always_returns, names_bound_by, own_scope, place_in, tree_of
from aos_protocol.documents import AbstractionMapping, LocalSource, Snippet


def check_result_order(mapping: AbstractionMapping, findings: Findings) -> None:
    """Warns (AOS121) of code that reads the result before it is there, or a variable of it before that one's
    turn: it finds `None`."""
    variables = mapping.local_variables
    results = [v for v in variables if v.source is LocalSource.SERVICE_RESPONSE and v.initial_value is None]
    waiting = {variable.name: f"by the code on line {variable.span.line}" for variable in results}
    before = dict.fromkeys(waiting, "when the call has ended")
    early = [field.value for field in mapping.activation.fields]
    early += [v.code for v in variables if v.source is LocalSource.TOPIC and v.code is not None]
    for snippet in early:
        _check(snippet, before, "Name local variables of parameters and topics", findings)
    for variable in results:
        waiting.pop(variable.name, None)  # It is gone where a second one has the name, which is told.
        if variable.code is not None:
            _check(variable.code, waiting, "Take it from `__input`, or put that variable first", findings)


def _check(snippet: Snippet, unset: dict[str, str], hint: str, findings: Findings) -> None:
    if not any(name in snippet.code for name in unset):
        return
    try:
        tree = tree_of(snippet.code, "exec")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return  # Told where the code is checked, or an expression over several lines.
    nodes = list(nodes_read(tree))
    own = {name for node in nodes for name in names_bound_by(node)}
    for node in nodes:
        if isinstance(node, ast.Compare) and any(isinstance(op, ast.Is | ast.IsNot) for op in node.ops):
            own |= {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
    for node in nodes:
        if isinstance(node, ast.Name) and node.id in unset and node.id not in own:
            own.add(node.id)
            span = place_in(snippet, node)
            message = f"`{node.id}` is `None` here: it is set later, {unset[node.id]}"
            findings.warning("AOS121", message, span, hint)


def check_input_fields(code: Snippet, tree: ast.AST, findings: Findings) -> None:
    """Reports AOS121 for `__input[...]`, and for a text in brackets behind a part of `__input`."""
    if any("__input" in names_bound_by(node) for node in ast.walk(tree)):
        return
    for node in nodes_read(tree):
        if not isinstance(node, ast.Subscript) or not _is_of_input(node.value):
            continue
        text = getattr(node.slice, "value", None)
        name = text if isinstance(text, str) else getattr(node.slice, "id", "")
        if isinstance(node.value, ast.Name) or isinstance(text, str):
            owner = ast.unparse(node.value)
            span = place_in(code, node)
            message = f"the fields of `{owner}` are attributes"
            findings.error("AOS121", message, span, f"Write `{owner}.{name or 'field'}`")


def _is_of_input(node: ast.AST) -> bool:
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return isinstance(node, ast.Name) and node.id == "__input"


def check_taken_away(variable: str, code: Snippet, tree: ast.Module, findings: Findings) -> None:
    """Reports AOS121 where a variable's code takes its value away, and no line below assigns another."""
    if always_returns(tree.body):
        return
    removal: ast.Name | ast.ExceptHandler | None = None
    assigned = (0, 0)
    for node in own_scope(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Del()) if name == variable:
                removal = node
            case ast.ExceptHandler(name=name, body=body) if name == variable:
                if not always_returns(body) and not isinstance(body[-1], ast.Continue):
                    removal = node
            case ast.stmt() | ast.expr() | ast.alias() | ast.pattern() if variable in names_bound_by(node):
                assigned = max(assigned, (node.lineno, node.col_offset))
    if removal is not None and assigned < (removal.end_lineno or 0, removal.end_col_offset or 0):
        hint = f"The value of `{variable}` is what it is at the end of its code"
        findings.error("AOS121", f"this takes `{variable}` away", place_in(code, removal), hint)
