"""Local variables that their own code leaves without a value, by `del` or at the end of `except ... as`."""

import ast

from aos_language.findings import Findings
from aos_language.python_syntax import always_returns, names_bound_by, own_scope, place_in
from aos_protocol.documents import Snippet


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
