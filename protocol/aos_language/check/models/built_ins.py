"""Calls of what AOS gives to model code, such as `AOS.Bernoulli(p)`, with the numbers that stand in them."""

import difflib
import re
from collections.abc import Callable, Collection, Iterator, Mapping

from aos_language.cpp.snippets import Call, Cpp, Extent, FaultKind, blanked, strip_comments
from aos_language.findings import Findings
from aos_protocol.diagnostics import Mend, Span
from aos_protocol.spelling import quoted

BUILT_INS = {
    "AOS": (
        "Bernoulli", "SampleDiscrete", "SampleNormal", "SampleUniform", "SetNull", "IsInitialized",
        "Initialize", "Uninitialize",
    ),
    "AOSUtils": ("Bernoulli", "SampleDiscrete", "SampleNormal", "SampleUniform"),
}  # fmt: skip
_BY_LOWER = {name.lower(): name for name in BUILT_INS["AOS"]}
_OWNER_BY_LOWER = {owner.lower(): owner for owner in BUILT_INS}
_ARGUMENTS = {
    "Bernoulli": (1, "a probability"),
    "SampleNormal": (2, "a mean and a deviation"),
    "SampleUniform": (2, "a lower and an upper bound"),
}
_CALLED = re.compile(rf"\b({'|'.join(BUILT_INS)})\s*(?:\.|::)\s*([A-Za-z_]\w*)\s*(?=\()")
_DECIMAL_COMMA = re.compile(r"\d+\s*,\s*\d+")
_WITH_TYPE = re.compile(r"[\w.\s]+<\s*(?P<type>[\w:]+)\s*>")
_ALIKE = 0.85
"""A share of a function's name, from 0 to 1: with that much of a built-in's name it is taken for a
misspelling. Any function of C++ may stand there as well."""


def check_built_in(
    call: Call, code: str, declared: Collection[str], span_of: Callable[[Extent], Span], findings: Findings
) -> None:
    """Reports AOS110 for a built-in that is not there, lacks its owner, or has it in another spelling.

    One with too many values or too few is told as well.
    """
    owner, name = call.name[0] if len(call.name) == 2 else "", call.name[-1] if call.name else ""
    span = span_of(call.function)
    text = code[call.function.start : call.function.end]
    if owner in BUILT_INS and name not in BUILT_INS[owner]:
        known = BUILT_INS[owner]
        start = call.function.start + text.rfind(name)
        of_name = span if "\n" in text else span_of(Extent(start, start + len(name)))
        findings.unknown(name, known, f"{owner} has no `{name}`", of_name, f"It has {quoted(known)}")
    elif owner in BUILT_INS and (written := _WITH_TYPE.fullmatch(text)):
        _typed(owner, name, written["type"], call, code, span, findings)
    elif owner in BUILT_INS and len(call.arguments) != _ARGUMENTS.get(name, (len(call.arguments), ""))[0]:
        given = code[call.function.end : call.extent.end]
        comma = " A decimal is written with a point" if _DECIMAL_COMMA.search(given) else ""
        count = len(call.arguments)
        message = f"`{text}` takes {_ARGUMENTS[name][1]}, not {count} value{'s' if count != 1 else ''}"
        findings.error("AOS110", message, span, comma.strip())
    elif owner == "AOS" and "::" in text:
        _written_otherwise(f"`{text}` is not how AOS writes it", "AOS", name, text, span, findings)
    elif len(call.name) == 2 and owner not in BUILT_INS and owner not in declared:
        meant = _OWNER_BY_LOWER.get(owner.lower(), "")
        if meant:
            _written_otherwise(f"unknown name `{owner}`", meant, _meant(name) or name, text, span, findings)
    elif len(call.name) == 1 and name not in declared and (meant := _meant(name)):
        _written_otherwise(f"unknown function `{name}`", "AOS", meant, text, span, findings)


def calls_of_no_built_in(cpp: Cpp) -> Iterator[Call]:
    """Calls such as `AOS.Bernouli(p)` in code that is not read because of a fault.

    What follows a quote without a partner is left out, up to the end of its line.
    """
    quotes = [fault.extent.start for fault in cpp.faults if fault.kind is FaultKind.QUOTE]
    unclear = [Extent(start, f"{cpp.code}\n".index("\n", start)) for start in quotes]
    code = blanked(strip_comments(cpp.code), (*cpp.literals, *unclear))
    for called in _CALLED.finditer(code):
        if called[2] not in BUILT_INS[called[1]]:
            extent = Extent(called.start(), called.end(2))
            yield Call((called[1], called[2]), extent, extent, ())


def _typed(
    owner: str, name: str, type_name: str, call: Call, code: str, span: Span, findings: Findings
) -> None:
    """Reports `AOS.SampleDiscrete<Room>({...})`, which emitted models have; documents name the enum first."""
    text = code[call.function.start : call.function.end]
    is_followed = code[call.function.end : call.function.end + 1] == "("
    right = f"{owner}.{name}({type_name}, " if name == "SampleDiscrete" else f"{owner}.{name}("
    mend = Mend(span, len(text) + 1, right) if is_followed and "\n" not in text else None
    hint = f"Write `{right}{'{weights}' if name == 'SampleDiscrete' else '...'})`"
    findings.error("AOS110", f"`{text}` is not how documents write it", span, hint, mend)


def _meant(name: str) -> str:
    """The built-in that a function's name is, or nearly is; empty where it is another function's."""
    close = difflib.get_close_matches(name.lower(), _BY_LOWER, n=1, cutoff=_ALIKE)
    return _BY_LOWER[close[0]] if close else ""


def _written_otherwise(
    message: str, owner: str, name: str, text: str, span: Span, findings: Findings
) -> None:
    right = f"{owner}.{name}"
    mend = Mend(span, len(text), right) if "\n" not in text else None
    findings.error("AOS110", message, span, f"Write `{right}`", mend)


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
        place = _written_list(arguments[-1], code) or call.arguments[-1]
        weights, rounding = _weights(code[place.start : place.end])
        if weights:
            size = enum_sizes.get(arguments[0]) if len(arguments) > 1 else None
            span = span_of(place)
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


def _written_list(name: str, code: str) -> Extent | None:
    """The list that a vector of the code is declared with, where nothing but one draw names it after that."""
    if not name.isidentifier() or len(re.findall(rf"\b{name}\b", code)) != 2:
        return None
    declared = re.search(rf"\bvector\s*<\s*(?:float|double)\s*>\s*{name}\s*=?\s*(\{{[^{{}}]*\}})\s*;", code)
    return Extent(*declared.span(1)) if declared is not None else None


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
