"""The environment file (`.ef`)."""

from __future__ import annotations

import re

from aos_protocol.diagnostics import Span
from aos_protocol.documents import (
    Assignment,
    CompoundType,
    EnumType,
    Environment,
    Field,
    SpecialState,
    StateVariable,
)
from aos_registry.documents.code import expression
from aos_registry.documents.document import check_name, enum_type
from aos_registry.documents.sdl_declaration import read_declaration, read_number
from aos_registry.documents.sdl_sections import DEFAULT_DISCOUNT, Sections
from aos_registry.documents.sdl_text import Part, Section
from aos_registry.documents.source import Findings, Text

__all__ = ["read_environment"]

_ARRAY_MARKS = {"[]": True, "true": True, "false": False, "": False}


def read_environment(sections: Sections, project: str, span: Span, findings: Findings) -> Environment:
    """The environment; what cannot be read of it is reported and left out."""
    types = [_type(section, findings) for section in sections.all("define_type")]
    variables = [
        _variable(section, findings) for section in sections.of("state_variable", "action_parameter")
    ]
    return Environment(
        project=project,
        span=span,
        horizon=_horizon(sections, findings),
        discount=_discount(sections, findings),
        enums=tuple(kind for kind in types if isinstance(kind, EnumType)),
        compounds=tuple(kind for kind in types if isinstance(kind, CompoundType)),
        variables=tuple(variable for variable in variables if variable is not None),
        initial_belief=sections.block("initial_belief"),
        special_states=tuple(_rewards(sections)),
        extrinsic_changes=sections.block("extrinsic_code"),
        state_heuristic=sections.block("heuristic_code"),
    )


def _horizon(sections: Sections, findings: Findings) -> int:
    section = sections.last("horizon")
    if section is None:
        findings.error("AOS105", "the environment lacks `horizon:`", sections.span)
        return 1
    number = read_number(section, findings)
    if number is None:
        return 1
    if number != int(number) or number < 1:
        findings.error("AOS106", "the horizon must be an integer of at least 1", section.value.span)
        return 1
    return int(number)


def _discount(sections: Sections, findings: Findings) -> float:
    section = sections.last("discount")
    number = read_number(section, findings) if section is not None else DEFAULT_DISCOUNT
    if number is None:
        return DEFAULT_DISCOUNT
    if section is not None and not 0.0 < number <= 1.0:
        hint = "It must be above 0 and at most 1"
        findings.error("AOS106", f"the discount is {number:g}", section.value.span, hint)
        return DEFAULT_DISCOUNT
    return number


def _rewards(sections: Sections) -> list[SpecialState]:
    found = []
    for section in sections.all("reward_code"):
        code = section.code()
        if code is not None:
            found.append(SpecialState(section.span, code=(Assignment(code.span, code=code),)))
    return found


def _type(section: Section, findings: Findings) -> EnumType | CompoundType | None:
    name = section.value
    if not name.text:
        findings.error("AOS105", "`define_type:` needs a name", section.span)
        return None
    if not check_name(name, "a type", findings):
        return None
    members = section.last("enum_members", findings)
    fields = [_field(part, findings) for part in section.all("variable")]
    if members is not None and fields:
        message = f"the type {name.text} is an enum or has variables, not both"
        findings.error("AOS106", message, members.span)
    if members is not None:
        return enum_type(name, _enum_values(members.value, findings), findings)
    if not fields:
        hint = "Add `enum_members:` or `variable:` lines"
        findings.error("AOS105", f"the type {name.text} is empty", name.span, hint)
    return CompoundType(name.text, tuple(field for field in fields if field is not None), name.span)


def _enum_values(text: Text, findings: Findings) -> list[Text]:
    pieces = [text.after(match.start()) for match in re.finditer(r"(?<![^,])[^,]*", text.text)]
    values = [Text(piece.text.split(",")[0], piece.span).strip() for piece in pieces]
    if values and not values[-1].text:  # A comma at the end.
        values.pop()
    if not values:
        findings.error("AOS105", "`enum_members:` needs names between commas", text.span)
    return values


def _field(part: Part, findings: Findings) -> Field | None:
    declaration = read_declaration(part, "a field", findings)
    if declaration is None:
        return None
    default = _without_learning_scale(declaration.rest)
    snippet = expression(default.snippet(), drop_semicolon=True) if default.text else None
    return Field(declaration.name.text, declaration.type, declaration.name.span, snippet)


def _without_learning_scale(rest: Text) -> Text:
    """The default without what AOS's learning planner wants behind it: a scale or `ml_ignore`."""
    match = re.fullmatch(r"(.*\S)\s+(ml_ignore|[\d.]+)", rest.text)
    return Text(match.group(1), rest.span) if match else rest


def _variable(section: Section, findings: Findings) -> StateVariable | None:
    is_parameter_value = section.word == "action_parameter"
    declaration = read_declaration(section, "a variable", findings)
    if declaration is None:
        return None
    rest = declaration.rest
    mark = rest.text.replace(" ", "").lower()
    if mark not in _ARRAY_MARKS:
        hint = "After the name stands `[]` for an array, or nothing; values go into `code:`"
        findings.error("AOS104", f"unexpected {rest.text!r}", rest.span, hint)
    code = section.last("code", findings)
    kind = declaration.type
    return StateVariable(
        name=declaration.name.text,
        type=kind.replace(" ", "").removesuffix("[]") if kind.rstrip().endswith("]") else kind,
        span=declaration.name.span,
        is_array=_ARRAY_MARKS.get(mark, False) or kind.rstrip().endswith("]"),
        is_parameter_value=is_parameter_value,
        default_code=code.code() if code is not None else None,
    )
