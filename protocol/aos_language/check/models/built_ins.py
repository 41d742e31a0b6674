"""Calls of what AOS gives to model code: `AOS.Bernoulli(p)` and its like."""

import difflib
import re
from collections.abc import Callable, Collection

from aos_language.cpp.snippets import Call, Extent
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
