"""The JSON form of model code: blocks of assignments, temporary variables, loops over state variables."""

import re

from msgspec.structs import replace

from aos_language.reading.document import check_name, enum_type, normal_type
from aos_language.reading.glued_else import with_else_apart
from aos_language.reading.json_record import Record
from aos_language.reading.source import joined
from aos_protocol.documents import Assignment, Iteration, TemporaryVariable

_FORM = '{"AssignmentCode": "..."}'
_ELSE = re.compile(r"(?:\s|//[^\n]*\n|/\*.*?\*/)*else\b", re.DOTALL)


def read_block(record: Record, key: str) -> tuple[Assignment, ...]:
    """The assignments of a block, in order; empty ones are left out.

    The code of a skill is one text in the original AOS. So an `else` may begin an assignment: it goes on with
    the one before.
    """
    blocks: list[Assignment] = []
    for item in record.records(key, f'an assignment of "{key}"', _FORM):
        block = _assignment(item)
        block = with_else_apart(block, record.findings) if block is not None else None
        if block is not None and blocks and (whole := _gone_on(blocks[-1], block)) is not None:
            blocks[-1] = whole
        elif block is not None:
            blocks.append(block)
    return tuple(blocks)


def _gone_on(before: Assignment, block: Assignment) -> Assignment | None:
    """Returns the one before with the code of one that begins with `else`; None for every other one."""
    if before.code is None or block.code is None or _ELSE.match(block.code.code) is None:
        return None
    if block.temporary or block.over_previous or block.over_next:
        return None
    return replace(before, code=joined(before.code, block.code))


def _assignment(record: Record) -> Assignment | None:
    name = record.text("AssignmentName")
    temporary = record.record("TempVar", "a temporary variable")
    block = Assignment(
        span=record.span,
        name=" ".join(name.text.split()) if name else "",
        temporary=_temporary(temporary) if temporary and not temporary.is_blank else None,
        over_previous=_iterations(record, "IteratePreviousStateVars"),
        over_next=_iterations(record, "IterateNextStateVars"),
        code=record.code("AssignmentCode"),
    )
    record.ignore("Comment")
    has_effect = block.temporary or block.over_previous or block.over_next or block.code
    if not has_effect and record.has_unread_text:
        record.lack("AssignmentCode")
    record.finish()
    return block if has_effect else None


def _iterations(record: Record, key: str) -> tuple[Iteration, ...]:
    found = []
    for item in record.records(key, f'a loop of "{key}"'):
        kind, name = item.text("Type", required=True), item.text("ItemName", required=True)
        condition = item.expression("ConditionCode")
        body = item.code("WhenConditionTrueCode")
        item.ignore("Comment")
        if body is None and item.has_unread_text:
            item.lack("WhenConditionTrueCode")
        item.finish()
        if kind and name:
            check_name(name, "a loop's item", record.findings)
            found.append(Iteration(kind.text, name.text, kind.span, condition, body))
    return tuple(found)


def _temporary(record: Record) -> TemporaryVariable | None:
    findings = record.findings
    name, kind = record.text("VarName", required=True), record.text("Type", required=True)
    enum_name, values = record.text("EnumName"), record.texts("EnumValues")
    record.ignore("Comment")
    record.finish()
    if name is None or kind is None:
        return None
    check_name(name, "a temporary variable", findings)
    if kind.text.lower() == "enum" != kind.text:
        findings.warning("AOS127", f"the kind {kind.text}", kind.span, "It is read as enum")
    if kind.text.lower() != "enum":
        return TemporaryVariable(name.text, normal_type(kind, findings), name.span)
    if enum_name is None or not values:
        missing = "EnumName" if enum_name is None else "EnumValues"
        findings.error("AOS105", f'the temporary enum {name.text} lacks "{missing}"', record.span)
        return None
    check_name(enum_name, "an enum", findings)
    enum = enum_type(enum_name, values, findings)
    return TemporaryVariable(name.text, "enum", name.span, enum.name, enum.values)
