"""Calls of the functions of shared code: has each the values that it takes?"""

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
