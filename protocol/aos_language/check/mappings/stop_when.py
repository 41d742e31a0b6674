"""`stop_when` of a mapping: does it name what is there while the skill runs, and can it become True?"""

import ast
import re

from aos_language.check.mappings.python_names import PythonNames, check_names
from aos_language.check.mappings.python_parsed import parsed
from aos_language.check.scope import Scope
from aos_language.findings import Findings
from aos_language.python_syntax import place_in
from aos_protocol.diagnostics import Severity
from aos_protocol.documents import AbstractionMapping, LocalSource, SkillModel, Snippet

_WORD = re.compile(r"[A-Za-z_]\w*")
_NO_TRUTH = (
    ast.Dict | ast.DictComp | ast.GeneratorExp | ast.JoinedStr | ast.Lambda | ast.List | ast.ListComp
    | ast.Set | ast.SetComp | ast.Tuple
)  # fmt: skip
_OF_NUMBERS = ast.Add | ast.Sub | ast.Mult | ast.Div | ast.FloorDiv | ast.Mod | ast.Pow | ast.MatMult


def check_stop_when(
    mapping: AbstractionMapping, model: SkillModel | None, scope: Scope, findings: Findings, *, is_whole: bool
) -> None:
    """Reports AOS110 for names that are not there while the skill runs, AOS106 for what is neither True nor
    False, and warns with AOS118 of an expression that no message can make true."""
    snippet = mapping.stop_when
    if snippet is None:
        return
    tree = parsed(snippet, "eval", findings)
    if tree is None:
        return
    severity = Severity.ERROR if is_whole else Severity.WARNING
    before = len(findings)
    check_names(snippet, tree, PythonNames.of(mapping, model, scope), findings, severity)
    _check_results(mapping, snippet, tree, findings)
    if len(findings) > before:
        return
    value = _value(tree)
    if isinstance(value, ast.Constant):
        _check_constant(snippet, value, findings)
    elif _is_no_truth(value):
        _neither(snippet, findings)
    elif not _heard(mapping, tree):
        hint = "It is looked at with each message: name a local variable of a topic"
        message = "`stop_when` reads no topic, so no message changes whether it holds"
        findings.warning("AOS118", message, snippet.span, hint)
    elif not mapping.monitor:
        _check_told(mapping, snippet, findings)


def _value(tree: ast.AST) -> ast.AST:
    """The expression itself; one over several lines was read between brackets."""
    match tree:
        case ast.Expression(body=body) | ast.Module(body=[ast.Expr(value=body)]):
            return body
    return tree


def _check_results(mapping: AbstractionMapping, snippet: Snippet, tree: ast.AST, findings: Findings) -> None:
    of_result = {v.name for v in mapping.local_variables if v.source is LocalSource.SERVICE_RESPONSE}
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in of_result:
            span = place_in(snippet, node)
            message = f"`{node.id}` comes from the result, which is not there while the skill runs"
            findings.error("AOS110", message, span, "Name local variables of topics and parameters")


def _check_constant(snippet: Snippet, value: ast.Constant, findings: Findings) -> None:
    if value.value is False:
        message = "`stop_when` never holds"
        findings.warning("AOS118", message, snippet.span, "Leave it out, or name a topic's local variable")
    elif value.value is True:
        message = "`stop_when` always holds: the first message on any topic stops the skill"
        findings.warning("AOS118", message, snippet.span, "Name a local variable of a topic")
    else:
        _neither(snippet, findings)


def _neither(snippet: Snippet, findings: Findings) -> None:
    message = f"`stop_when` is neither True nor False: `{' '.join(snippet.code.split())}`"
    findings.error("AOS106", message, snippet.span, "Write a condition, such as `battery < 0.2`")


def _is_no_truth(value: ast.AST) -> bool:
    """Returns whether an expression is certainly no truth value, whatever its names stand for."""
    if isinstance(value, ast.BinOp):
        return isinstance(value.op, _OF_NUMBERS)
    if isinstance(value, ast.UnaryOp):
        return not isinstance(value.op, ast.Not)
    return isinstance(value, _NO_TRUTH)


def _heard(mapping: AbstractionMapping, tree: ast.AST) -> bool:
    """Returns whether the expression reads a local variable of a topic."""
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    topics = {v.name for v in mapping.local_variables if v.source is LocalSource.TOPIC}
    return bool(names & topics)


def _check_told(mapping: AbstractionMapping, snippet: Snippet, findings: Findings) -> None:
    if not tells_of_stops(mapping):
        message = f"no rule of {mapping.name} says what is observed when `stop_when` has stopped the skill"
        hint = "Begin the rules with one for `__skill_status == 'stopped'`: there is no result then"
        findings.warning("AOS116", message, snippet.span, hint)


def tells_of_stops(mapping: AbstractionMapping) -> bool:
    """Returns whether a rule may hold for a skill that was stopped, with None for what the result gives."""
    if mapping.response_variable or not mapping.rules:
        return True
    of_result = {v.name for v in mapping.local_variables if v.source is LocalSource.SERVICE_RESPONSE}
    others = {v.name for v in mapping.local_variables} - of_result | {"__skill_status", "__skill_error"}
    for rule in mapping.rules:
        words = set(_WORD.findall(rule.condition.code)) if rule.condition is not None else set()
        if words & others or not words & of_result:
            return True
    return False
