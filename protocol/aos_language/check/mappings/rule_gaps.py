"""Numbers for which no response rule holds."""

import ast
import math
import operator
from itertools import pairwise

from aos_language.findings import Findings
from aos_language.python_syntax import tree_of
from aos_protocol.documents import AbstractionMapping

_ORDER = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


def check_rule_gaps(mapping: AbstractionMapping, findings: Findings) -> None:
    """Warns (AOS118) where the rules compare one number with constants, and one between these is left
    out."""
    rules = [_compared(rule.condition.code if rule.condition is not None else "") for rule in mapping.rules]
    if mapping.monitor or mapping.response_variable or len(rules) < 2 or None in rules:
        return
    tests = [test for rule in rules if rule is not None for test in rule]
    names = {name for name, _, _ in tests}
    limits = sorted({limit for _, _, limit in tests})
    if len(names) != 1 or not any(order in (ast.Lt, ast.LtE, ast.Gt, ast.GtE) for _, order, _ in tests):
        return
    between = [(low + high) / 2 for low, high in pairwise(limits)]
    numbers = sorted({limits[0] - 1, *limits, *between, limits[-1] + 1})
    if any(local.name in names and local.type == "int" for local in mapping.local_variables):
        numbers = sorted({float(math.floor(number)) for number in numbers})
    held = [any(_holds(rule or [], number) for rule in rules) for number in numbers]
    for at, number in enumerate(numbers):
        if not held[at] and any(held[:at]) and any(held[at:]):
            message = f"no rule holds where {names.pop()} is {number:g}: what comes back is then unknown"
            last = mapping.rules[-1]
            span = last.condition.span if last.condition is not None else last.span
            findings.warning("AOS118", message, span, "Let the limits meet, or end with the rule `True`")
            return


def _holds(rule: list[tuple[str, type[ast.cmpop], float]], number: float) -> bool:
    return all(_ORDER[order](number, limit) for _, order, limit in rule)


def _compared(code: str) -> list[tuple[str, type[ast.cmpop], float]] | None:
    """The comparisons of a name with a number that all hold where the rule does; None for other code."""
    try:
        body = tree_of(code.strip(), "eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    node = body.body if isinstance(body, ast.Expression) else body
    tests = []
    for part in node.values if isinstance(node, ast.BoolOp) and isinstance(node.op, ast.And) else [node]:
        match part:
            case ast.Compare(left=ast.Name(id=name), ops=[op], comparators=[limit]) if type(op) in _ORDER:
                value = _number(limit)
                if value is None:
                    return None
                tests.append((name, type(op), value))
            case ast.Compare(
                left=low, ops=[ast.Lt() | ast.LtE() as op, last], comparators=[ast.Name(id=name), high]
            ):
                least, most = _number(low), _number(high)
                if least is None or most is None or type(last) not in (ast.Lt, ast.LtE):
                    return None
                tests += [
                    (name, ast.Gt if isinstance(op, ast.Lt) else ast.GtE, least),
                    (name, type(last), most),
                ]
            case _:
                return None
    return tests


def _number(node: ast.AST) -> float | None:
    try:
        value = ast.literal_eval(node)
    except (ValueError, TypeError):
        return None
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None
