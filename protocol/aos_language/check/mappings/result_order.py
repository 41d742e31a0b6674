"""Local variables of a call's result that are read where they have no value yet."""

import ast

from aos_language.check.mappings.python_names import nodes_read
from aos_language.findings import Findings
from aos_language.python_syntax import names_bound_by, place_in, tree_of
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
