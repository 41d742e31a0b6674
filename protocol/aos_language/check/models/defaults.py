"""The code that sets variables at the start: each sets its own."""

import re

from aos_language.cpp.snippets import Access, Mention, read_cpp, read_cpp_expression
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Environment, StateVariable


def check_defaults(environment: Environment, findings: Findings) -> None:
    """Reports AOS141 for a default that sets other variables only or reads one that has its own later, and
    for an element that several defaults set."""
    later = {one.name for one in environment.variables if one.default_code or one.default_value}
    first: dict[str, tuple[str, Span]] = {}
    for variable in environment.variables:
        later.discard(variable.name)
        _check_order(variable, later, findings)
        writes = _writes(variable)
        others = [mention for mention in writes if mention.path[1] != variable.name]
        if others and len(others) == len(writes):
            message = f"the default of {variable.name} sets `{others[0].text}`, and not the variable itself"
            hint = "Is it a copy of another default?"
            findings.warning("AOS141", message, _span(variable, others[0]), hint)
            continue
        for mention in writes:
            place = _span(variable, mention)
            name, span = first.setdefault(_element(variable, mention), (variable.name, place))
            if name != variable.name:
                message = f"the defaults of {name} and {variable.name} both set `{mention.text}`"
                findings.warning("AOS141", message, place, f"The first is at {span}")


def _check_order(variable: StateVariable, later: set[str], findings: Findings) -> None:
    for snippet, read in ((variable.default_code, read_cpp), (variable.default_value, read_cpp_expression)):
        for mention in read(snippet.code).mentions if snippet is not None else ():
            root, *names = mention.path
            if root == "state" and names and names[0] in later and mention.access is Access.READ:
                assert snippet is not None
                place = snippet.at(mention.root.start)
                message = f"the default of {variable.name} reads `{mention.text}` before that has its own"
                findings.warning("AOS141", message, place, f"Declare {variable.name} below {names[0]}")


def _writes(variable: StateVariable) -> list[Mention]:
    """The changes of state variables in the code of a default."""
    cpp = read_cpp(variable.default_code.code) if variable.default_code is not None else None
    if cpp is None or cpp.faults:
        return []
    return [mention for mention in cpp.writes() if mention.path[0] == "state" and len(mention.path) > 1]


def _element(variable: StateVariable, mention: Mention) -> str:
    """Returns the text that is set; a change of a value that is there already is another one for each
    variable."""
    assert variable.default_code is not None
    written = variable.default_code.code[mention.extent.start : mention.extent.end]
    is_set = mention.access is Access.WRITE
    return re.sub(r"\s+", "", written) if is_set else f"{variable.name}: {written}"


def _span(variable: StateVariable, mention: Mention) -> Span:
    assert variable.default_code is not None
    return variable.default_code.at(mention.root.start)
