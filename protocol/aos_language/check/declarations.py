"""Names and types: everything is declared once, under a usable name, with a type that exists.

A mission parameter is one value or a structure of such, there before any state is.
"""

from collections.abc import Iterable

from aos_language.check.scope import Scope
from aos_language.cpp.keywords import CPP_KEYWORDS, DRAW_SOURCES, OUR_NAMES
from aos_language.cpp.snippets import Cpp, read_cpp, read_cpp_expression
from aos_language.findings import Findings
from aos_language.mission_parameters import parameter_leaves
from aos_language.reading.document import array_type
from aos_protocol.diagnostics import Severity, Span
from aos_protocol.documents import CompoundType, Environment, SkillModel, Snippet, StateVariable
from aos_protocol.spelling import quoted


def check_environment_names(environment: Environment, scope: Scope, findings: Findings) -> None:
    """Types, enum values and variables of the environment."""
    types = [(enum.name, enum.span) for enum in environment.enums]
    types += [(compound.name, compound.span) for compound in environment.compounds]
    values = [pair for enum in environment.enums for pair in zip(enum.values, enum.value_spans, strict=True)]
    _check_unique([*types, *values], "a type or an enum value", findings)
    _check_unique([(v.name, v.span) for v in environment.variables], "a variable", findings)
    for compound in environment.compounds:
        _check_unique([(f.name, f.span) for f in compound.fields], f"a field of {compound.name}", findings)
        for field in compound.fields:
            element, _, index_enum = array_type(field.type)
            _check_type(element, field.type_span or field.span, scope, findings)
            _check_low_level_type(field.low_level_type, field.low_level_span or field.span, scope, findings)
            _check_index(index_enum, field.type_span or field.span, scope, findings)
    _check_cycles(environment.compounds, scope, findings)
    for variable in environment.variables:
        _check_type(variable.type, variable.type_span or variable.span, scope, findings)
        _check_low_level_type(
            variable.low_level_type, variable.low_level_span or variable.span, scope, findings
        )
        _check_index(variable.index_enum, variable.index_span or variable.span, scope, findings)
        for key in variable.key_types:
            if not key.startswith("(") and key not in scope.enums:
                otherwise = "A key is an enum or (start,stop,step)"
                findings.unknown(key, scope.enums, f"unknown enum `{key}`", variable.span, otherwise)


def check_skill_declarations(model: SkillModel, scope: Scope, findings: Findings) -> None:
    """A skill's parameters: names, types, and that there are values for them."""
    parameters = [(parameter.name, parameter.span) for parameter in model.parameters]
    _check_unique(parameters, "a parameter", findings)
    _check_unique([(model.name, model.span)], "a skill", findings)
    for parameter in model.parameters:
        type_span = parameter.type_span or parameter.span
        if parameter.type_span == parameter.span:
            continue  # It has no type, as is told already.
        if not _check_type(parameter.type, type_span, scope, findings) or model.possible_parameters:
            continue
        values = [v for v in scope.variables.values() if v.is_parameter_value and v.type == parameter.type]
        if not values and parameter.type not in scope.enums:
            hint = (
                f"Declare action parameters of type {parameter.type} in the environment, "
                "or let the skill's own code list them"
            )
            message = f"the parameter {parameter.name} of {model.name} has no values"
            findings.error("AOS119", message, parameter.span, hint)
    if model.possible_parameters and not model.parameters:
        span = model.possible_parameters[0].span
        findings.warning("AOS119", "this skill has no parameters to list values for", span)


def _check_unique(names: Iterable[tuple[str, Span]], what: str, findings: Findings) -> None:
    first: dict[str, Span] = {}
    for name, span in names:
        if name in CPP_KEYWORDS or name in OUR_NAMES:
            findings.error("AOS126", f"`{name}` means something else in C++", span, "Choose another name")
        elif name in first:
            hint = f"The first is at {first[name]}"
            findings.error("AOS126", f"`{name}` is already the name of {what}", span, hint)
        first.setdefault(name, span)


INSTEAD = {
    "bitset": 'Declare an array of bool: `bool name []` in SDL, `"IsArray": true` in JSON',
    "optional": "Declare the value, and beside it a bool that says whether there is one",
    "variant": "Declare a variable of each type, and an enum that says which of them counts",
}
"""Types of the standard library that no state holds, and what to declare in their place."""


def _check_type(name: str, span: Span, scope: Scope, findings: Findings) -> bool:
    unknown = scope.unknown_type_name(name)
    if not unknown:
        return True
    otherwise = f"The types are {quoted(scope.type_names)}"
    if unknown in INSTEAD:
        a = "an" if unknown[0] in "aeiou" else "a"
        findings.error("AOS110", f"no state can hold {a} `{unknown}`", span, INSTEAD[unknown])
        return False
    if (kind := next((each.kind for each in scope.shared.names if each.name == unknown), "")) != "":
        hint = "Declare it with `define_type:`" if kind == "enum" else "Write the type that it stands for"
        message = f"`{unknown}` is of the shared code, which only code sees"
        findings.error("AOS110", message, span, hint)
        return False
    findings.unknown(unknown, scope.type_names, f"unknown type `{unknown}`", span, otherwise)
    return False


def _check_index(enum: str, span: Span, scope: Scope, findings: Findings) -> None:
    """An array is indexed by an enum of the environment."""
    if enum and enum not in scope.enums and (enum in scope.type_names or not scope.unknown_type_name(enum)):
        message = f"`{enum}` is no enum, and cannot be what an array is indexed by"
        findings.error("AOS110", message, span, f"The enums are {quoted(scope.enums)}" if scope.enums else "")
    elif enum and enum not in scope.enums:
        findings.unknown(enum, scope.enums, f"unknown enum `{enum}`", span)


def _check_low_level_type(name: str | None, span: Span, scope: Scope, findings: Findings) -> None:
    if name is not None and name not in scope.low_level_types:
        message = f"unknown low-level type `{name}`"
        findings.unknown(name, scope.low_level_types, message, span, severity=Severity.WARNING)


def _check_cycles(compounds: Iterable[CompoundType], scope: Scope, findings: Findings) -> None:
    """A compound cannot hold itself, not through others either."""
    for compound in compounds:
        reached: set[str] = set()
        waiting = [compound.name]
        while waiting:
            inner = scope.compounds[waiting.pop()]
            new = {field.type for field in inner.fields if field.type in scope.compounds} - reached
            reached |= new
            waiting += new
        if compound.name in reached:
            findings.error("AOS106", f"the type {compound.name} holds itself", compound.span)


def check_mission_parameters(environment: Environment, scope: Scope, findings: Findings) -> None:
    """Reports AOS106 for a type that nobody could set a value of, and AOS124 for a default that is drawn, or
    that depends on what is not there yet."""
    names = {leaf.split(".")[0].split("[")[0] for leaf in parameter_leaves(environment)}
    before: set[str] = set()
    for variable in environment.variables:
        if not variable.is_mission_parameter:
            continue
        _check_kind(variable, variable.name in names, scope, findings)
        for snippet, cpp in _defaults(variable):
            _check_default(variable, snippet, cpp, before, scope, findings)
        before.add(variable.name)


def _check_kind(variable: StateVariable, can_be_set: bool, scope: Scope, findings: Findings) -> None:
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
