"""The fields of results and messages are attributes: code that takes them by brackets is told."""

import ast

from aos_language.check.mappings.python_names import nodes_read
from aos_language.findings import Findings
from aos_language.python_syntax import names_bound_by, place_in
from aos_protocol.documents import Snippet


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
