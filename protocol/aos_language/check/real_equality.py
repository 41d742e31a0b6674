"""Equality of a real number with a decimal that rounding makes it miss."""

import re
from collections.abc import Iterator
from fractions import Fraction

from aos_language.check.blocks import Block, environment_blocks, read_block, skill_blocks
from aos_language.check.scope import STATE_COPIES, Scope, ValueType
from aos_language.cpp.snippets import Access, Cpp
from aos_language.findings import Findings
from aos_protocol.documents import Environment

_COMPARED = re.compile(r"\s*[=!]=\s*(-?\d*\.\d+)(?!\s*[-+*/]|[\w.])")
_COMPUTED = re.compile(r"[\w)\]]\s*[-+*/]|AOS\.Sample(?:Normal|Uniform)")


def check_real_equality(environment: Environment, scope: Scope, findings: Findings) -> None:
    """Reports AOS149 for a float that is compared with what no float is, and for a double that code computes
    or draws."""
    models = scope.skills.values()
    blocks = (*environment_blocks(environment), *(block for model in models for block in skill_blocks(model)))
    read = [(block, read_block(block)) for block in blocks]
    computed = {name for _, cpp in read for name in _computed(cpp)}
    for block, cpp in read:
        for mention in cpp.mentions:
            compared = _COMPARED.match(cpp.code, mention.extent.end)
            kind = _type_of(mention.path, block, scope) if compared is not None else ""
            if compared is None or Fraction(compared[1]) == Fraction(float(compared[1])):
                continue
            span = block.snippet.locate(mention.extent.line, mention.extent.column)
            hint = f"Write `std::abs({mention.text} - {compared[1]}) < 1e-6`"
            if kind == "float":
                findings.warning("AOS149", f"no float is exactly {compared[1]}", span, hint)
            elif kind == "double" and _last_name(mention.path) in computed:
                message = f"`{mention.text}` is computed, and rounding may make it miss {compared[1]}"
                findings.remark("AOS149", message, span, hint)


def _computed(cpp: Cpp) -> Iterator[str]:
    """The last names of what a calculation or a draw sets."""
    for mention in cpp.mentions:
        given = cpp.code[mention.assigned.start : mention.assigned.end] if mention.assigned else ""
        if (mention.access is Access.UPDATE and not mention.method) or _COMPUTED.search(given):
            yield _last_name(mention.path)


def _last_name(path: tuple[str, ...]) -> str:
    return next(part for part in reversed(path) if part != "[]")


def _type_of(path: tuple[str, ...], block: Block, scope: Scope) -> str:
    """The type at the end of an access path of the documents; empty for another."""
    root, *parts = path
    is_state = root in STATE_COPIES and parts
    kind = scope.state_member(parts.pop(0)) if is_state else ValueType(block.names.get(root, ""))
    for part in parts:
        if kind is not None and part == "[]":
            kind = ValueType(kind.name)
        elif kind is not None:
            compound = scope.compounds.get(kind.name)
            fields = compound.fields if compound is not None else ()
            kind = next((ValueType.of(field.type) for field in fields if field.name == part), None)
    return kind.name if kind is not None and not kind.is_container else ""
