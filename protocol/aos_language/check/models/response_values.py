"""The values that model code gives as a response: a number in the place of a name or a text is told.

C++ takes both in silence: the first as a place in the list of responses, the second as one letter.
"""

import re
from collections.abc import Iterable

from aos_language.check.models.blocks import Block
from aos_language.check.scope import Scope
from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Cpp
from aos_language.cpp.values import values
from aos_language.findings import Findings
from aos_protocol.spelling import quoted

_NUMBER = re.compile(r"(?:const )?(?:bool|double|float|int|long|short|size_t|unsigned)")


def check_response_values(
    given: tuple[str, ...], read: Iterable[tuple[Block, Cpp]], scope: Scope, findings: Findings
) -> None:
    """Warns of numbers in the place of the responses that are `given` or of a text (AOS116).

    These are no errors: code that appends a letter by its number may mean it.
    """
    for block, cpp in read:
        for mention in cpp.mentions:
            is_text = mention.path == ("__moduleResponseStr",)
            if mention.assigned is None or not (is_text or mention.path == ("__moduleResponse",)):
                continue
            assigned = mention.assigned
            for kind, value, offset in values(cpp.text(assigned)):
                span = block.snippet.at(assigned.start + offset)
                is_number = kind == "number_literal"
                if is_text and (type_name := "number" if is_number else _type_of(value, block, cpp, scope)):
                    message = f"__moduleResponseStr takes a text, and `{value}` is of the type {type_name}"
                    is_variable = not is_number and value not in scope.enum_values
                    as_text = f"Write `std::to_string({value})`, or a text in quotes"
                    hint = as_text if is_variable else f'Write it in quotes: `"{value}"`'
                    findings.warning("AOS116", message, span, hint)
                elif not is_text and is_number and given:
                    message = f"`{value}` is a number, and no name of a response"
                    findings.warning("AOS116", message, span, f"The responses are {quoted(given)}")


def _type_of(value: str, block: Block, cpp: Cpp, scope: Scope) -> str:
    """The type of a name that is a number or an enum's value; empty for others, and where nobody knows."""
    copy, _, name = value.rpartition(".")
    if copy in STATES and (member := scope.state_member(name)) is not None:
        kind = "" if member.is_container else member.name
    else:
        declared = {declaration.name: declaration.type for declaration in cpp.declarations}
        kind = {**scope.enum_values, **block.names, **declared}.get(value, "")
    return kind if _NUMBER.fullmatch(kind) or kind in scope.enums else ""
