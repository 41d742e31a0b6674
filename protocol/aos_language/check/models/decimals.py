"""Decimals in model code that rounding makes a comparison miss, and those that a whole number loses."""

import re
from collections.abc import Iterator
from fractions import Fraction

from aos_language.check.models.blocks import DURATION, Block, all_blocks, read_block
from aos_language.check.scope import Scope, ValueType
from aos_language.cpp.keywords import DRAW_SOURCES, STATES
from aos_language.cpp.snippets import Access, Cpp, Extent, Mention
from aos_language.findings import Findings
from aos_protocol.documents import Environment

_COMPARED = re.compile(r"\s*[=!]=\s*(-?\d*\.\d+)(?!\s*[-+*/]|[\w.])")
_COMPUTED = re.compile(r"[\w)\]]\s*[-+*/]|AOS\.Sample(?:Normal|Uniform)")
_FRACTION = re.compile(r"\s*[-+]?\d*\.\d*[1-9]\d*f?\s*")
_DIVISION = re.compile(r"(?<![\w.)\]])\b([\w.]+)\s*/\s*([\w.]+)(?![\w.(\[])")
_CALCULATED = re.compile(r"[*/<>=]\s*$")
_REAL = re.compile(r"(?<![\w.])\d*\.\d+|AOS\.Sample(?:Normal|Uniform)\b")
_ROUNDED = re.compile(r"[?<>=!]|\b(?:round|lround|floor|ceil|trunc|int)\b")
_SET = re.compile(r"\s*[-+]?=\s*")
_TIME = "__moduleExecutionTime"


def check_decimals(environment: Environment, scope: Scope, findings: Findings) -> None:
    """Reports AOS149 for a float that is compared with what no float is, for a double that code computes or
    draws, and for a fraction that a whole number is given."""
    read = [(block, read_block(block)) for block in all_blocks(environment, scope.skills.values())]
    computed = {name for _, cpp in read for name in _computed(cpp)}
    for block, cpp in read:
        for mention in cpp.mentions:
            _check_compared(mention, block, cpp, computed, scope, findings)
        for divided in _divided_wholes(block, cpp, scope):
            span = block.snippet.at(divided.start)
            text = cpp.text(divided)
            message = f"`{text}` is a whole number: the fraction of this probability is cut off"
            first, rest = text.split("/", 1)
            real = f"{first.strip()}.0 /{rest}" if first.strip().isdigit() else f"1.0 * {text}"
            findings.warning("AOS149", message, span, f"Write `{real}`")
        for name, given in _wholes(block, cpp, scope):
            text = cpp.text(given).strip()
            span = block.snippet.at(given.start)
            hint = "The fraction is cut off: round it, or count in a smaller unit"
            findings.warning("AOS149", f"`{name}` is a whole number, and `{text}` is none", span, hint)


def _check_compared(
    mention: Mention, block: Block, cpp: Cpp, computed: set[str], scope: Scope, findings: Findings
) -> None:
    compared = _COMPARED.match(cpp.code, mention.extent.end)
    kind = _type_of(mention.path, block, scope) if compared is not None else ""
    if compared is None or Fraction(compared[1]) == Fraction(float(compared[1])):
        return
    span = block.snippet.at(mention.extent.start)
    hint = f"Write `std::abs({mention.text} - {compared[1]}) < 1e-6`"
    if kind == "float":
        findings.warning("AOS149", f"no float is exactly {compared[1]}", span, hint)
    elif kind == "double" and _last_name(mention.path) in computed:
        message = f"`{mention.text}` is computed, and rounding may make it miss {compared[1]}"
        findings.remark("AOS149", message, span, hint)


def _wholes(block: Block, cpp: Cpp, scope: Scope) -> Iterator[tuple[str, Extent]]:
    """The whole numbers that are given a fraction, each with what it is given.

    A calculation is looked at for the execution time alone: elsewhere C++ is often meant to cut.
    """
    for mention in cpp.mentions:
        given = mention.assigned
        if given is None or not _SET.fullmatch(cpp.code[mention.extent.end : given.start]):
            continue
        text = cpp.text(given)
        is_time = mention.path == (_TIME,) and block.role is DURATION
        is_real = is_time and _REAL.search(text) and not _ROUNDED.search(text)
        if is_real or (
            _FRACTION.fullmatch(text) and (is_time or _type_of(mention.path, block, scope) == "int")
        ):
            yield mention.text, given
    for declared in cpp.declarations:
        given = declared.initial
        text = cpp.text(given) if given is not None else ""
        if given is not None and declared.type in ("int", "const int") and _FRACTION.fullmatch(text):
            yield declared.name, given
    if block.type == "int" and _FRACTION.fullmatch(cpp.code):
        yield block.sets, Extent(0, len(cpp.code))


def _divided_wholes(block: Block, cpp: Cpp, scope: Scope) -> Iterator[Extent]:
    """The divisions of whole numbers that stand in probabilities and weights."""
    kinds = {each.name: each.type.removeprefix("const ") for each in cpp.declarations}
    kinds |= {
        cpp.text(each.extent): _type_of(each.path, block, scope)
        for each in cpp.mentions
        if each.path[0] not in kinds
    }
    for call in cpp.calls:
        if not {*call.name[:1]} & DRAW_SOURCES or call.name[-1] not in ("Bernoulli", "SampleDiscrete"):
            continue
        for argument in call.arguments:
            for found in _DIVISION.finditer(cpp.code, argument.start, argument.end):
                sides = [side for side in found.groups() if not side.isdigit()]
                are_whole = sides and all(kinds.get(side) in ("int", "size_t", "unsigned") for side in sides)
                if are_whole and not _CALCULATED.search(cpp.code, argument.start, found.start()):
                    yield Extent(*found.span())


def _computed(cpp: Cpp) -> Iterator[str]:
    """The last names of what a calculation or a draw sets."""
    for mention in cpp.mentions:
        given = cpp.text(mention.assigned) if mention.assigned else ""
        if (mention.access is Access.UPDATE and not mention.method) or _COMPUTED.search(given):
            yield _last_name(mention.path)


def _last_name(path: tuple[str, ...]) -> str:
    return next(part for part in reversed(path) if part != "[]")


def _type_of(path: tuple[str, ...], block: Block, scope: Scope) -> str:
    """The type at the end of an access path of the documents; empty for another."""
    root, *parts = path
    is_state = root in STATES and parts
    kind = scope.state_member(parts.pop(0)) if is_state else ValueType(block.names.get(root, ""))
    for part in parts:
        if kind is not None and part == "[]":
            kind = ValueType(kind.name)
        elif kind is not None:
            compound = scope.compounds.get(kind.name)
            fields = compound.fields if compound is not None else ()
            kind = next((ValueType.of(field.type) for field in fields if field.name == part), None)
    return kind.name if kind is not None and not kind.is_container else ""
