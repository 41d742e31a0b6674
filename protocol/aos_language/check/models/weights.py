"""Probabilities and weights that stand as numbers in the model code."""

import re
from collections.abc import Callable, Mapping

from aos_language.cpp.snippets import Call, Extent
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[fF]?")
_WEIGHT_LIST = re.compile(
    r"(?:(?:std::)?vector\s*<\s*(?:float|double)\s*>\s*\(?\s*)?\{(.*)\}\s*\)?", re.DOTALL
)
_TOLERANCE = 1e-6


def check_weights(
    call: Call,
    code: str,
    enum_sizes: Mapping[str, int],
    span_of: Callable[[Extent], Span],
    findings: Findings,
) -> None:
    """Checks the literal numbers of a call that draws; expressions are left alone."""
    arguments = [code[argument.start : argument.end] for argument in call.arguments]
    if call.name[1] == "Bernoulli" and arguments:
        probability = _number(arguments[0])
        if probability is not None and not 0.0 <= probability <= 1.0:
            span = span_of(call.arguments[0])
            findings.error("AOS122", f"{probability:g} is no probability", span, "It lies between 0 and 1")
    elif call.name[1] == "SampleDiscrete" and arguments:
        weights, rounding = _weights(arguments[-1])
        if weights:
            size = enum_sizes.get(arguments[0]) if len(arguments) > 1 else None
            span = span_of(call.arguments[-1])
            _check_list(weights, size, span, findings, rounding if call.name[0] == "AOS" else None)
    elif call.name[1] in ("SampleNormal", "SampleUniform") and len(arguments) == 2:
        first, second = _number(arguments[0]), _number(arguments[1])
        if second is not None:
            _check_distribution(call.name[1], first, second, span_of(call.arguments[1]), findings)


def _check_distribution(
    name: str, first: float | None, second: float, span: Span, findings: Findings
) -> None:
    if name == "SampleNormal" and second < 0.0:
        findings.error("AOS122", f"{second:g} is no standard deviation", span, "It is not negative")
    elif name == "SampleUniform" and first is not None and second < first:
        findings.warning("AOS122", f"the upper bound {second:g} lies below the lower one", span)


def _check_list(
    weights: list[float], size: int | None, span: Span, findings: Findings, rounding: float | None
) -> None:
    """`rounding` is what the sum may miss because of the digits left out; None where nothing is divided."""
    total = sum(weights)
    if min(weights) < 0.0:
        findings.error("AOS122", f"{min(weights):g} is no weight", span, "Weights are not negative")
    elif total == 0.0:
        findings.error("AOS122", "these weights are all zero", span, "At least one must be above 0")
    elif size is not None and len(weights) == 1 < size:
        hint = "Write one for each value of the enum, 0 for one that never comes"
        findings.error("AOS122", f"1 weight for {size} values: it always gives the first", span, hint)
    elif size is not None and len(weights) > size:
        findings.error("AOS122", f"{len(weights)} weights for {size} values", span)
    elif rounding is not None and abs(total - 1.0) > rounding + _TOLERANCE:
        hint = "They are divided by their sum"
        findings.warning("AOS122", f"these weights add up to {total:.6g}", span, hint)
    elif rounding is None and abs(total - 1.0) > _TOLERANCE:
        hint = "AOSUtils gives -1 for a missing part, and divides only where the sum is above 1"
        findings.warning("AOS122", f"these weights add up to {total:.6g}", span, hint)
    elif size is not None and len(weights) < size:
        # In the original, too, a weight that is missing is 0.
        message = f"{len(weights)} weights for {size} values: those behind them never come"
        findings.warning("AOS122", message, span, "Write 0 for a value that never comes")


def _weights(text: str) -> tuple[list[float], float]:
    """The numbers of a literal list, none where one is an expression; how far rounding moves their sum."""
    match = _WEIGHT_LIST.fullmatch(text.strip())
    if match is None:
        return [], 0.0
    items = [item.strip() for item in match.group(1).rstrip(", \n").split(",")]
    numbers = [number for item in items if (number := _number(item)) is not None]
    if len(numbers) < len(items):
        return [], 0.0
    decimals = max(len(item.rstrip("fF").partition(".")[2]) for item in items)
    return numbers, len(items) * 0.5 * 10.0**-decimals


def _number(text: str) -> float | None:
    text = text.strip()
    return float(text.rstrip("fF")) if _NUMBER.fullmatch(text) else None
