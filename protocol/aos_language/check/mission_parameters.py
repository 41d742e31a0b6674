"""The declarations of mission parameters: one value or a structure of such, there before any state is."""

from aos_language.check.scope import Scope
from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.snippets import Cpp, read_cpp, read_cpp_expression
from aos_language.findings import Findings
from aos_language.mission_parameters import parameter_leaves
from aos_protocol.documents import Environment, Snippet, StateVariable


def check_mission_parameters(environment: Environment, scope: Scope, findings: Findings) -> None:
    """Reports AOS106 for a type that nobody could set a value of, and AOS124 for a default that is drawn, or
    that depends on what is not there yet."""
    names = {leaf.split(".")[0].split("[")[0] for leaf in parameter_leaves(environment)}
    before: set[str] = set()
    for variable in environment.variables:
        if not variable.is_mission_parameter:
            continue
        _check_type(variable, variable.name in names, scope, findings)
        for snippet, cpp in _defaults(variable):
            _check_default(variable, snippet, cpp, before, scope, findings)
        before.add(variable.name)


def _check_type(variable: StateVariable, can_be_set: bool, scope: Scope, findings: Findings) -> None:
    is_list = (variable.is_array and not variable.index_enum) or bool(variable.key_types)
    if can_be_set and not is_list:
        return
    if scope.unknown_type_name(variable.type) or (
        variable.index_enum and variable.index_enum not in scope.enums
    ):
        return  # That is told already.
    message = f"nobody could set a value for the mission parameter {variable.name}"
    hint = (
        "It is a bool, int, float, double, string or an enum's value, a compound type of such, "
        "or an array over an enum"
    )
    findings.error("AOS106", message, variable.type_span or variable.span, hint)


def _defaults(variable: StateVariable) -> list[tuple[Snippet, Cpp]]:
    value, code = variable.default_value, variable.default_code
    read = [(value, read_cpp_expression(value.code))] if value is not None else []
    return [*read, *([(code, read_cpp(code.code))] if code is not None else [])]


def _check_default(
    variable: StateVariable, snippet: Snippet, cpp: Cpp, before: set[str], scope: Scope, findings: Findings
) -> None:
    for mention in cpp.mentions:
        root = mention.path[0]
        span = snippet.at(mention.root.start)
        if root in DRAW_SOURCES or root in scope.shared.drawing:
            message = f"the default of the mission parameter {variable.name} is drawn at random"
            hint = "It is the same in all states of a mission; let the initial belief draw a state variable"
            findings.error("AOS124", message, span, hint)
            return
        if root != "state" or (len(mention.path) > 1 and mention.path[1] in before | {variable.name}):
            continue
        message = f"the default of the mission parameter {variable.name} depends on `{mention.text}`"
        hint = "It is there before the state is: name constants, and mission parameters declared before it"
        findings.error("AOS124", message, span, hint)
        return
