"""Preconditions that nothing keeps: a skill runs also where its precondition does not hold."""

import re
from collections.abc import Iterable

from aos_language.cpp.snippets import Access
from aos_language.document_code import snippets_of
from aos_language.findings import Findings
from aos_protocol.documents import Assignment, SkillModel

_MEETS = "__meetPrecondition"
_ALWAYS = re.compile(rf"\s*(?:{_MEETS}\s*=\s*(?:true|1)\s*;?\s*)?")
"""Code that says that a skill may always be used."""
_TRUE = re.compile(rf"\s*=\s*(?:true|1|{_MEETS}\s*\|\|.*)|\s*\|=.*", re.DOTALL)
"""Settings that leave a precondition met that is met already."""


def check_precondition(model: SkillModel, findings: Findings) -> None:
    """Remarks on a precondition whose violation costs nothing and changes nothing in the model."""
    if not model.precondition:
        return
    block = model.precondition[0]
    span = block.code.span if block.code is not None else block.span
    if _is_never_false(model.precondition):
        message = f"this precondition is never false: {_MEETS} starts as true"
        findings.warning("AOS147", message, span, f"Begin with `{_MEETS} = false;`")
        return
    if model.violation_penalty or not _mentions(model.precondition) or _mentions(model.dynamic_model):
        return
    if all(_ALWAYS.fullmatch(snippet.code) for snippet, _ in snippets_of(model.precondition)):
        return
    message = f"nothing keeps the planner from using {model.name} where this does not hold"
    penalty = '"ViolatingPreconditionPenalty"' if span.file.endswith(".json") else "violate_penalty"
    hint = f"Add `{penalty}: -10`, or say in the dynamic model what happens where {_MEETS} is false"
    findings.remark("AOS147", message, span, hint)


def _is_never_false(block: Iterable[Assignment]) -> bool:
    """Returns whether code looks at something, and sets that the precondition holds wherever it sets it."""
    snippets = [cpp for _, cpp in snippets_of(block)]
    sets = [
        cpp.code[mention.extent.end : mention.assigned.end if mention.assigned is not None else None]
        for cpp in snippets
        for mention in cpp.mentions
        if mention.path == (_MEETS,) and mention.access is not Access.READ
    ]
    looks = any(mention.path[0] != _MEETS for cpp in snippets for mention in cpp.mentions)
    return looks and bool(sets) and all(_TRUE.fullmatch(text) for text in sets)


def _mentions(block: Iterable[Assignment]) -> bool:
    """Says whether code reads or sets whether the precondition holds."""
    return any(mention.path[0] == _MEETS for _, cpp in snippets_of(block) for mention in cpp.mentions)
