"""The Python of the mappings: does it parse, which names does it use, and which rules can fire?"""

from __future__ import annotations

import ast
import builtins
import keyword
import re
import warnings
from collections.abc import Iterable

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
from aos_protocol.findings import Findings
from aos_protocol.spelling import quoted
from aos_registry.check.scope import Scope

__all__ = ["check_low_level", "check_mapping"]

_PATH = re.compile(r"/?[A-Za-z0-9_-]+(/[A-Za-z0-9_-]+)*")
_BUILT_IN_NAMES = frozenset(dir(builtins))
_OF_SKILL = frozenset({"__skill_status", "__skill_error"})
"""What rules can say of a skill that has failed."""


def check_mapping(
    mapping: AbstractionMapping, model: SkillModel | None, scope: Scope, findings: Findings
) -> None:
    """Rules, local variables and the request of one mapping."""
    _check_path(mapping.activation.path, mapping.activation.span, findings)
    _check_local_names(mapping, findings)
    known = _known_names(mapping)
    for rule in mapping.rules:
        _check_expression(rule.condition, known and known | _OF_SKILL, findings)
        for assignment in rule.assignments:
            made = scope.low_level_types | scope.low_level_names
            _check_expression(assignment.value, known and known | made, findings)
            if model is not None and scope.has_environment:
                _check_assigned(assignment, model, scope, findings)
    _check_order(mapping.rules, findings)
    for field in mapping.activation.fields:
        _check_expression(field.value, known, findings)
    for variable in mapping.local_variables:
        _check_variable(variable, findings)
        if variable.source is LocalSource.PARAMETER and model is not None:
            _check_parameter(variable, model, scope, findings)
    if model is not None:
        _check_passed_on(mapping, model, findings)
    local_names = [variable.name for variable in mapping.local_variables]
    if mapping.response_variable and mapping.response_variable not in local_names:
        message = f"unknown local variable `{mapping.response_variable}`"
        span = mapping.response_variable_span or mapping.span
        findings.unknown(mapping.response_variable, local_names, message, span, _listing(local_names))


def check_low_level(document: LowLevelDocument, findings: Findings) -> None:
    """The code that makes low-level constants."""
    for constant in document.constants:
        _parse(constant.code, "exec", findings)


def _check_path(path: str, span: Span, findings: Findings) -> None:
    if not _PATH.fullmatch(path):
        hint = "A path is made of letters, digits, _ and -, with / between"
        findings.error("AOS126", f"{path!r} cannot be a path", span, hint)


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
    for field in mapping.activation.fields:
        if keyword.iskeyword(field.name):
            message = f"the field `{field.name}` is a word of Python"
            findings.error("AOS126", message, field.value.span, "Choose another name")


def _known_names(mapping: AbstractionMapping) -> frozenset[str] | None:
    """The names an expression may use; None where an `import *` brings names we cannot know."""
    imports = [*mapping.activation.imports]
    for variable in mapping.local_variables:
        imports += variable.imports
    names = [name.split(" as ")[-1].strip().split(".")[0] for item in imports for name in item.names]
    if "*" in names:
        return None
    return _BUILT_IN_NAMES.union(names, (variable.name for variable in mapping.local_variables))


# --- code ----------------------------------------------------------------------------------------------


def _check_expression(snippet: Snippet | None, known: frozenset[str] | None, findings: Findings) -> None:
    """Parses an expression; a name that nothing gives is a warning, since it fails only when it runs."""
    tree = _parse(snippet, "eval", findings) if snippet is not None else None
    if snippet is None or tree is None or known is None:
        return
    bound = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
    bound |= {argument.arg for argument in ast.walk(tree) if isinstance(argument, ast.arg)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id not in known | bound:
            column = _column(snippet, node.lineno, node.col_offset)
            span = snippet.locate(node.lineno, column)
            message = f"no local variable gives `{node.id}`"
            findings.unknown(node.id, sorted(known), message, span, severity=Severity.WARNING)


def _check_variable(variable: LocalVariable, findings: Findings) -> None:
    if variable.source is LocalSource.TOPIC:
        _check_path(variable.topic, variable.source_span or variable.span, findings)
    if variable.initial_value is not None:
        _parse(variable.initial_value, "eval", findings)
    if variable.code is None:
        return
    tree = _parse(variable.code, "exec", findings)
    if tree is None:
        return
    assigned = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    if variable.name in assigned:
        return
    if variable.source is LocalSource.SERVICE_RESPONSE:
        message = f"this code never assigns `{variable.name}`"
        hint = f"It assigns {quoted(sorted(assigned))}" if assigned else "Write `name = ...`"
        findings.error("AOS121", message, variable.code.span, hint)
    elif not any(isinstance(node, ast.Return) for node in ast.walk(tree)):
        hint = f"Without it {variable.name} stays as it was, whatever the message says"
        findings.warning("AOS121", "this code returns nothing", variable.code.span, hint)


def _parse(snippet: Snippet, mode: str, findings: Findings) -> ast.AST | None:
    """The syntax tree; None, with an error at its place, where it is not Python."""
    code = snippet.code
    is_long = mode == "eval" and "\n" in code  # An expression may go on in the next line.
    # What closes one kind of brackets and opens it again does not pass in the other.
    texts = (f"(\n{code}\n)", f"[\n{code}\n]") if is_long else (code,)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree, *_ = [ast.parse(text, mode=mode) for text in texts]
            return ast.increment_lineno(tree, -1) if is_long else tree
    except SyntaxError as error:
        # Python gives no column where the code ends too early.
        end = len(code) - (code.rfind("\n") + 1) + 1
        span = snippet.locate((error.lineno or 1) - is_long, error.offset or end)
        findings.error("AOS121", f"this is not Python: {error.msg}", span)
    except (ValueError, RecursionError, MemoryError) as error:
        findings.error("AOS121", f"this cannot be read as Python: {error}", snippet.span)
    return None


def _column(snippet: Snippet, line: int, byte_offset: int) -> int:
    """A column from 1 for an offset in UTF-8 bytes, as `ast` gives it."""
    text = snippet.code.split("\n")[line - 1]
    return len(text.encode()[:byte_offset].decode(errors="ignore")) + 1


# --- rules ---------------------------------------------------------------------------------------------


def _check_order(rules: tuple[ResponseRule, ...], findings: Findings) -> None:
    """The first rule that holds wins: what stands behind an always-true rule never fires."""
    always: ResponseRule | None = None
    seen: dict[str, ResponseRule] = {}
    for rule in rules:
        truth = _constant_truth(rule.condition)
        key = rule.condition.code if rule.condition is not None else "True"
        span = _condition_span(rule)
        if always is not None:
            hint = f"The rule on line {_condition_span(always).line} always holds"
            findings.warning("AOS118", f"the rule for {rule.response} never fires", span, hint)
        elif truth is False:
            findings.warning("AOS118", f"the rule for {rule.response} never fires", span)
        elif key in seen:
            hint = f"The rule on line {_condition_span(seen[key]).line} has the same condition"
            findings.warning("AOS118", f"the rule for {rule.response} never fires", span, hint)
        if always is None and truth is True:
            always = rule
        seen.setdefault(key, rule)


def _condition_span(rule: ResponseRule) -> Span:
    return rule.condition.span if rule.condition is not None else rule.span


def _constant_truth(condition: Snippet | None) -> bool | None:
    if condition is None:
        return True
    try:
        return bool(ast.literal_eval(condition.code))
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return None


# --- parameters ----------------------------------------------------------------------------------------


def _check_parameter(variable: LocalVariable, model: SkillModel, scope: Scope, findings: Findings) -> None:
    name, *fields = variable.parameter_path.split(".")
    span = variable.source_span or variable.span
    parameters = {parameter.name: parameter.type for parameter in model.parameters}
    if name not in parameters:
        message = f"the skill {model.name} has no parameter `{name}`"
        findings.unknown(name, parameters, message, span, _listing(parameters))
        return
    _field_type(parameters[name], fields, span, scope, findings)


def _check_passed_on(mapping: AbstractionMapping, model: SkillModel, findings: Findings) -> None:
    """AOS140 for each parameter of the skill that no local variable takes: the robot never hears of it."""
    taken = {
        variable.parameter_path.split(".")[0]
        for variable in mapping.local_variables
        if variable.source is LocalSource.PARAMETER
    }
    if taken - {parameter.name for parameter in model.parameters}:
        return  # A name that is told as unknown may have been meant for the missing one.
    for parameter in model.parameters:
        if parameter.name not in taken:
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
            message = f"the type {kind} has no field `{field}`"
            findings.unknown(field, types, message, span, _listing(types))
            return ""
        kind = types[field]
    return kind


def _listing(known: Iterable[str]) -> str:
    names = quoted(sorted(known))
    return f"There are {names}" if names else ""
