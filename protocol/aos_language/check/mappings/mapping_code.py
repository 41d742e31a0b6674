"""The Python of the mappings: does it parse, which names does it use, and which rules can fire?"""

import ast
import keyword
from collections.abc import Iterable, Iterator

from aos_language.check.mappings import python_names
from aos_language.check.mappings.python_parsed import parsed
from aos_language.check.mappings.result_uses import check_input_fields, check_result_order, check_taken_away
from aos_language.check.mappings.rule_gaps import check_rule_gaps
from aos_language.check.mappings.value_uses import check_value_uses
from aos_language.check.scope import Scope
from aos_language.findings import Findings
from aos_language.local_types import ELEMENTS, OF_SKILL, local_type
from aos_language.python_syntax import own_scope, place_in, tree_of
from aos_protocol.diagnostics import Severity, Span
from aos_protocol.documents import (
    AbstractionMapping,
    LocalSource,
    LocalVariable,
    LowLevelAssignment,
    LowLevelDocument,
    ResponseRule,
    SkillModel,
    Snippet,
)
from aos_protocol.keys import PATH
from aos_protocol.spelling import nearest, quoted

_IDLE = (ast.Attribute, ast.BinOp, ast.Compare, ast.Constant, ast.Name)


def check_mapping(
    mapping: AbstractionMapping, model: SkillModel | None, scope: Scope, findings: Findings, *, is_whole: bool
) -> None:
    """Rules, local variables and the request of one mapping.

    Where the documents are not read as a `whole`, a local variable that seems missing may stand in the rest.
    """
    if not mapping.monitor:
        _check_path(mapping.activation.path, mapping.activation.span, findings)
    _check_local_names(mapping, findings)
    _check_classes(mapping, findings)
    names = python_names.PythonNames.of(mapping, model, scope)
    severity = Severity.ERROR if is_whole else Severity.WARNING
    _check_rules(mapping, model, names, scope, findings, severity)
    _check_order(mapping.rules, findings)
    check_rule_gaps(mapping, findings)
    check_result_order(mapping, findings)
    # Documents that are only planned with may have a request from elsewhere and nothing that it could name.
    of_request = severity if mapping.local_variables else Severity.WARNING
    names_of_fields: set[str] = set()
    for field in mapping.activation.fields:
        if field.name in names_of_fields:
            message = f"a second value for the field `{field.name}` of the call"
            findings.error("AOS126", message, field.value.span, "Take one of the two out")
        names_of_fields.add(field.name)
        _check_expression(field.value, names, findings, of_request)
    for variable in mapping.local_variables:
        _check_variable(variable, names, findings, severity)
        if variable.source is LocalSource.PARAMETER and model is not None:
            _check_parameter(variable, model, scope, findings)
    if model is not None:
        _check_passed_on(mapping, model, findings)
        check_value_uses(mapping, snippets_of_mapping(mapping), model, scope, findings)
    local_names = [variable.name for variable in mapping.local_variables]
    if mapping.response_variable and mapping.response_variable not in local_names:
        message = f"unknown local variable `{mapping.response_variable}`"
        span = mapping.response_variable_span or mapping.span
        findings.unknown(mapping.response_variable, local_names, message, span, _listing(local_names))


def check_low_level(
    document: LowLevelDocument, mappings: Iterable[AbstractionMapping], scope: Scope, findings: Findings
) -> None:
    """The code that makes low-level constants."""
    names = python_names.PythonNames.of_constants(mappings, scope)
    types = [type.name for type in document.types]
    for constant in document.constants:
        if constant.type not in types and nearest(constant.type, types):
            message = f"unknown low-level type `{constant.type}`"
            findings.unknown(constant.type, types, message, constant.span, severity=Severity.WARNING)
        tree = parsed(constant.code, "exec", findings)
        if tree is not None:
            python_names.check_names(constant.code, tree, names, findings)
            python_names.check_fields_set(constant, tree, document.types, findings)


def snippets_of_mapping(mapping: AbstractionMapping) -> Iterator[Snippet]:
    for rule in mapping.rules:
        yield from [rule.condition] if rule.condition is not None else []
        yield from (assignment.value for assignment in rule.assignments)
    yield from [mapping.stop_when] if mapping.stop_when is not None else []
    yield from (field.value for field in mapping.activation.fields)
    for variable in mapping.local_variables:
        yield from (snippet for snippet in (variable.initial_value, variable.code) if snippet is not None)


def _check_path(path: str, span: Span, findings: Findings) -> None:
    if not PATH.fullmatch(path):
        hint = "A path is made of letters, digits, _ and -, with / between"
        findings.error("AOS126", f"{path!r} cannot be a path", span, hint)


def _check_classes(mapping: AbstractionMapping, findings: Findings) -> None:
    """Warns of a service or a message whose type is called nearly as one that the mapping imports."""
    imported = {name for each in mapping.imports if each.module for name in each.names}
    own = {name for name in imported if not name.endswith(("Request", "Response"))}
    used = [(mapping.activation.service_type, mapping.activation.span)]
    used += [(each.message_type, each.source_span or each.span) for each in mapping.local_variables]
    for name, span in used if "*" not in imported else ():
        if name and name not in imported and (close := nearest(name, own)):
            message = f"nothing imports `{name}`"
            findings.warning("AOS110", message, span, f"Did you mean `{close}`?")


def _check_local_names(mapping: AbstractionMapping, findings: Findings) -> None:
    first: dict[str, LocalVariable] = {}
    for variable in mapping.local_variables:
        if keyword.iskeyword(variable.name):
            message = f"`{variable.name}` is a word of Python"
            findings.error("AOS126", message, variable.span, "Choose another name")
        elif variable.name in first:
            hint = f"The first is at {first[variable.name].span}"
            findings.error("AOS126", f"a second local variable `{variable.name}`", variable.span, hint)
        first.setdefault(variable.name, variable)


# --- code ---


def _check_rules(
    mapping: AbstractionMapping,
    model: SkillModel | None,
    names: python_names.PythonNames,
    scope: Scope,
    findings: Findings,
    severity: Severity,
) -> None:
    before: list[ast.AST] = []
    severity = Severity.WARNING if mapping.response_variable else severity
    for rule in mapping.rules:
        for snippet in (rule.condition, *(assignment.value for assignment in rule.assignments)):
            if snippet is not None:
                tree = _check_expression(snippet, names.of_rules(before), findings, severity)
                before += [tree] if tree is not None else []
                if tree is not None and snippet is rule.condition:
                    _check_condition(snippet, tree, findings)
        if model is not None and scope.has_environment:
            for assignment in rule.assignments:
                _check_assigned(assignment, model, scope, findings)
        if _constant_truth(rule.condition) is True:
            severity = Severity.WARNING  # What stands behind a rule that always holds never runs.


def _check_expression(
    snippet: Snippet, names: python_names.PythonNames, findings: Findings, severity: Severity = Severity.ERROR
) -> ast.AST | None:
    tree = parsed(snippet, "eval", findings)
    if tree is not None:
        python_names.check_names(snippet, tree, names, findings, severity)
    return tree


def _check_condition(condition: Snippet, tree: ast.AST, findings: Findings) -> None:
    """Warns of a part that Python takes for true whatever it is: `a < 0,2`, and the 2 of `a == 1 or 2`.

    A lone comma at the end is told where the code is read.
    """
    match tree:
        case ast.Expression(body=ast.BoolOp(values=parts)):
            pass
        case ast.Expression(body=whole):
            parts = [whole]
        case _:
            return
    for part in parts:
        match part:
            case ast.Tuple(elts=[first, _, *_]) | ast.List(elts=[first, *_]) | ast.Set(elts=[first, *_]):
                place, hint = first, "A decimal is written with a point"
            case ast.Constant(value=value) if value and value is not True and len(parts) > 1:
                place, hint = part, "Write each comparison in full"
            case _:
                continue
        message = f"`{ast.unparse(part)}` is no condition, and counts as true"
        findings.warning("AOS149", message, place_in(condition, place), hint)


def _check_variable(
    variable: LocalVariable, names: python_names.PythonNames, findings: Findings, severity: Severity
) -> None:
    if variable.type and local_type(variable.type) is None and nearest(variable.type, ELEMENTS):
        message = f"unknown type `{variable.type}` of the local variable {variable.name}"
        findings.unknown(variable.type, ELEMENTS, message, variable.span, severity=Severity.WARNING)
    if variable.source is LocalSource.TOPIC:
        _check_path(variable.topic, variable.source_span or variable.span, findings)
    if variable.initial_value is not None:
        _check_expression(variable.initial_value, names.at_start(), findings, severity)
    if variable.code is None:
        return
    tree = parsed(variable.code, "exec", findings)
    if tree is None:
        return
    python_names.check_names(variable.code, tree, names.of_code(), findings, severity)
    for node in (each for each in ast.walk(tree) if isinstance(each, ast.Global)):
        message = f"`global {', '.join(node.names)}` would reach the next activation"
        hint = f"Each activation begins anew. Between its messages `{variable.name}` keeps its value"
        findings.error("AOS121", message, place_in(variable.code, node), hint)
    check_input_fields(variable.code, tree, findings)
    _check_ends(variable, variable.code, tree, findings)
    if isinstance(tree, ast.Module):
        check_taken_away(variable.name, variable.code, tree, findings)


def _check_ends(variable: LocalVariable, code: Snippet, tree: ast.AST, findings: Findings) -> None:
    """Looks at what leaves a variable's code: what it assigns, and what it returns."""
    assigned = python_names.top_level_names(tree)
    returns = [node for node in own_scope(tree) if isinstance(node, ast.Return)]
    for node in returns:
        if node.value is None:
            message = f"`return` without a value makes {variable.name} `None`"
            span = place_in(code, node)
            hint = f"Write `return {variable.name}`, or `return None` where that is meant"
            findings.warning("AOS121", message, span, hint)
    if variable.name in assigned or (returns and variable.source is LocalSource.TOPIC):
        for part in python_names.nodes_read(tree):
            if not isinstance(part, ast.Expr) or isinstance(part.value, ast.Constant):
                continue
            if all(
                isinstance(each, (*_IDLE, ast.cmpop, ast.expr_context, ast.operator))
                for each in ast.walk(part.value)
            ):
                findings.warning("AOS149", "this line does nothing", place_in(code, part))
        return
    if variable.source is LocalSource.SERVICE_RESPONSE:
        message = f"this code never assigns `{variable.name}`"
        hint = f"It assigns {quoted(sorted(assigned))}" if assigned else f"Write `{variable.name} = ...`"
        findings.error("AOS121", message, code.span, hint)
    elif not returns:
        hint = f"Without it {variable.name} stays as it was, whatever the message says"
        findings.warning("AOS121", "this code returns nothing", code.span, hint)


# --- rules ---


def _check_order(rules: tuple[ResponseRule, ...], findings: Findings) -> None:
    """The first rule that holds wins: behind an always-true rule only those fire that look at how a skill has
    failed."""
    always: ResponseRule | None = None
    conditions: dict[str, ResponseRule] = {}
    for rule in rules:
        truth = _constant_truth(rule.condition)
        key = rule.condition.code if rule.condition is not None else "True"
        span = _condition_span(rule)
        if always is not None and any(name in key for name in OF_SKILL):
            continue
        if always is not None:
            hint = f"The rule on line {_condition_span(always).line} always holds"
            findings.warning("AOS118", f"the rule for {rule.response} never fires", span, hint)
        elif truth is False:
            findings.warning("AOS118", f"the rule for {rule.response} never fires", span)
        elif key in conditions:
            hint = f"The rule on line {_condition_span(conditions[key]).line} has the same condition"
            findings.warning("AOS118", f"the rule for {rule.response} never fires", span, hint)
        if always is None and truth is True:
            always = rule
        conditions.setdefault(key, rule)


def _condition_span(rule: ResponseRule) -> Span:
    return rule.condition.span if rule.condition is not None else rule.span


def _constant_truth(condition: Snippet | None) -> bool | None:
    if condition is None:
        return True
    try:
        return bool(ast.literal_eval(tree_of(condition.code.lstrip(" \t"), "eval")))
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return None


# --- parameters ---


def _check_parameter(variable: LocalVariable, model: SkillModel, scope: Scope, findings: Findings) -> None:
    name, *fields = variable.parameter_path.split(".")
    span = variable.source_span or variable.span
    parameters = {parameter.name: parameter.type for parameter in model.parameters}
    if name not in parameters:
        message = f"the skill {model.name} has no parameter `{name}`"
        findings.unknown(name, parameters, message, span, _listing(parameters) or "It has none: declare it")
        return
    _field_type(parameters[name], fields, span, scope, findings)


def _check_passed_on(mapping: AbstractionMapping, model: SkillModel, findings: Findings) -> None:
    """Reports AOS140 for each parameter of the skill that no local variable takes: the robot never hears
    of it."""
    passed = {
        variable.parameter_path.split(".")[0]
        for variable in mapping.local_variables
        if variable.source is LocalSource.PARAMETER
    }
    if passed - {parameter.name for parameter in model.parameters}:
        return  # A name that is told as unknown may have been meant for the missing one.
    for parameter in model.parameters:
        if parameter.name not in passed:
            message = (
                f"the abstraction mapping of {model.name} never passes on the parameter {parameter.name}"
            )
            hint = f"Add a local variable with `action_parameter: {parameter.name}`, and a field that uses it"
            findings.warning("AOS140", message, parameter.span, hint)


def _check_assigned(
    assignment: LowLevelAssignment, model: SkillModel, scope: Scope, findings: Findings
) -> None:
    """A rule may give a new value to what has a low-level one: an `anyValue`."""
    name, *fields = assignment.path.removeprefix("state.").split(".")
    parameters = {parameter.name: parameter.type for parameter in model.parameters}
    types = {variable.name: variable.type for variable in scope.variables.values()} | parameters
    if name not in types:
        message = f"there is no parameter and no state variable `{name}`"
        findings.unknown(name, types, message, assignment.span, _listing(types))
        return
    kind = _field_type(types[name], fields, assignment.span, scope, findings)
    if kind not in ("", "anyValue"):
        hint = "The model changes the state; a rule gives new low-level values"
        findings.error("AOS110", f"`{assignment.path}` is no anyValue, but {kind}", assignment.span, hint)


def _field_type(kind: str, fields: list[str], span: Span, scope: Scope, findings: Findings) -> str:
    """The type at a path into `kind`; empty if there is none, with a finding where the documents can tell."""
    for field in fields:
        compound = scope.compounds.get(kind)
        if compound is None:
            if scope.has_environment and not scope.unknown_type_name(kind):
                findings.error("AOS110", f"`{field}` of a {kind}, which has no fields", span)
            return ""
        types = {inner.name: inner.type for inner in compound.fields}
        if field not in types:
            findings.unknown(field, types, f"the type {kind} has no field `{field}`", span, _listing(types))
            return ""
        kind = types[field]
    return kind


def _listing(known: Iterable[str]) -> str:
    names = quoted(sorted(known))
    return f"There are {names}" if names else ""
