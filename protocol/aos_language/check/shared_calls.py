"""Calls of the functions of shared code, in C++ and in Python: has each the values that it takes?"""

import ast

from aos_language.cpp.shared import SharedCode
from aos_language.cpp.snippets import Call
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.spelling import quoted


def check_shared_call(call: Call, shared: SharedCode, span: Span, findings: Findings) -> None:
    """Reports AOS110 for a call with more or fewer values than any function of its name takes."""
    functions = [function for function in shared.functions if (function.name,) == call.name]
    count = len(call.arguments)
    takes = (range(f.needs, len(f.written) + 1) for f in functions if "..." not in "".join(f.written))
    if functions and len(counts := list(takes)) == len(functions) and not any(count in c for c in counts):
        message = f"`{call.name[0]}` is called with {count} value{'s' if count != 1 else ''}"
        forms = quoted(f"{function.name}({', '.join(function.written)})" for function in functions)
        findings.error("AOS110", message, span, f"Shared code has {forms}")


def check_python_call(call: ast.Call, function: ast.FunctionDef, span: Span, findings: Findings) -> None:
    """Reports AOS110 for a call in a mapping whose values the shared function does not take."""
    takes, keywords = function.args, [keyword.arg for keyword in call.keywords]
    is_open = any(isinstance(value, ast.Starred) for value in call.args) or None in keywords
    if is_open or takes.vararg or takes.kwarg:
        return
    names = [argument.arg for argument in (*takes.posonlyargs, *takes.args)]
    needed = names[: len(names) - len(takes.defaults)]
    needed += [
        a.arg for a, default in zip(takes.kwonlyargs, takes.kw_defaults, strict=True) if default is None
    ]
    given = [*names[: len(call.args)], *keywords]
    known = {*names, *(argument.arg for argument in takes.kwonlyargs)}
    is_taken = len(call.args) <= len(names) and known.issuperset(given) and len(given) == len({*given})
    if not is_taken or not {*needed}.issubset(given):
        message = f"`{function.name}` does not take these values"
        hint = f"Shared code has `{function.name}({ast.unparse(takes)})`"
        findings.error("AOS110", message, span, hint)
