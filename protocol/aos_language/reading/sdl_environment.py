"""The environment file (`.ef`), and its Python side (`.lf`): the values behind `anyValue`.

AOS 2.0 has no low-level file; it is ours.
"""

import re
from collections.abc import Iterator, Sequence

from aos_language.findings import Findings
from aos_language.reading.document import array_type, check_name, enum_type
from aos_language.reading.sdl_declaration import Declaration, read_declaration, read_number, read_truth
from aos_language.reading.sdl_sections import DEFAULT_DISCOUNT, Sections, read_block
from aos_language.reading.sdl_text import Part, Section, listed_values
from aos_language.reading.source import Text, expression
from aos_protocol import documents
from aos_protocol.diagnostics import Span
from aos_protocol.documents import LowLevelConstant, LowLevelDocument, LowLevelType, Parameter

_KEY = re.compile(r"\(\s*-?\d+\s*,\s*-?\d+\s*,\s*-?\d+\s*\)|\w+")
_KEYS = re.compile(rf"(?:{_KEY.pattern})(?:\s*,\s*(?:{_KEY.pattern}))*")
_LOW_LEVEL_TYPE = re.compile(r"(?:^|(?<=\s)|(?<=\]))of\s+([A-Za-z_]\w*)(?:\s+|$)")
_ARRAY_MARK = re.compile(r"\[\s*([A-Za-z_]\w*|)\s*\]\s*")
_ARRAY_WORDS = {"true": True, "false": False, "": False}


def read_environment(sections: Sections, project: str, span: Span) -> documents.Environment:
    """The environment; what cannot be read of it is reported and left out."""
    names = [section.value.text for section in sections.all("define_type")]
    types = [_type(section, names) for section in sections.all("define_type")]
    variables = [
        _variable(section, names)
        for section in sections.of("state_variable", "action_parameter", "mission_parameter")
    ]
    return documents.Environment(
        project=project,
        span=span,
        horizon=_horizon(sections),
        discount=_discount(sections),
        enums=tuple(kind for kind in types if isinstance(kind, documents.EnumType)),
        compounds=tuple(kind for kind in types if isinstance(kind, documents.CompoundType)),
        variables=tuple(variable for variable in variables if variable is not None),
        initial_belief=sections.block("initial_belief"),
        special_states=tuple(_special_states(sections)),
        extrinsic_changes=sections.block("extrinsic_code"),
        state_heuristic=sections.block("heuristic_code"),
        print_state=sections.block("print_code"),
        is_one_state_model=read_truth(sections.last("one_state_model")),
        shared_mapping_code=sections.code("shared_mapping_code"),
        monitors=tuple(_monitors(sections)),
        shared_code=sections.code("shared_code"),
    )


def _monitors(sections: Sections) -> Iterator[documents.MonitorModel]:
    """The model of each monitor; an error for one without a name or without code."""
    for section in sections.all("monitor"):
        name, code = section.value, section.code_of("code")
        if not name.text:
            section.error("AOS105", "`monitor:` needs a name")
        elif code is None:
            hint = "Add `code:` that sets __moduleResponse from `state`"
            sections.findings.error("AOS105", f"the monitor {name.text} has no model", name.span, hint)
        elif check_name(name, "a monitor", sections.findings):
            yield documents.MonitorModel(name.text, name.span, (documents.Assignment(code.span, code=code),))


def _horizon(sections: Sections) -> int:
    section = sections.last("horizon")
    if section is None:
        sections.findings.error("AOS105", "the environment lacks `horizon:`", sections.span)
        return 1
    number = read_number(section)
    if number is None:
        return 1
    if number != int(number) or not 1 <= number <= documents.MAX_HORIZON:
        message = f"the horizon must be an integer from 1 to {documents.MAX_HORIZON}"
        sections.findings.error("AOS106", message, section.value.span)
        return 1
    return int(number)


def _discount(sections: Sections) -> float:
    section = sections.last("discount")
    number = read_number(section) if section is not None else DEFAULT_DISCOUNT
    if number is None:
        return DEFAULT_DISCOUNT
    if section is not None and not 0.0 < number <= 1.0:
        hint = "It must be above 0 and at most 1"
        sections.findings.error("AOS106", f"the discount is {number:g}", section.value.span, hint)
        return DEFAULT_DISCOUNT
    return number


def _special_states(sections: Sections) -> Iterator[documents.SpecialState]:
    for section in sections.of("reward_code", "special_state"):
        if section.word == "special_state":
            special = _form_a(section)
        else:
            code = read_block(section)
            special = documents.SpecialState(section.span, code=code) if code else None
        if special is not None:
            yield special


def _form_a(section: Section) -> documents.SpecialState | None:
    code, reward = section.code_of("state_condition"), section.last("reward")
    is_goal = read_truth(section.last("is_goal_state"))
    is_one_time = read_truth(section.last("is_one_time_reward"))
    failure = section.last("is_failure_state")
    is_failure = read_truth(failure) if failure is not None else None
    if code is None:
        section.error("AOS105", "a special state needs `state_condition:`")
    if reward is None:
        section.error("AOS105", "a special state needs `reward:`")
    number = read_number(reward) if reward is not None else None
    if code is None or number is None:
        return None
    holds = expression(code, drop_semicolon=True)
    return documents.SpecialState(section.span, holds, number, is_goal, is_one_time, is_failure)


def _type(section: Section, names: Sequence[str]) -> documents.EnumType | documents.CompoundType | None:
    name = section.value
    if not name.text:
        section.error("AOS105", "`define_type:` needs a name")
        return None
    check_name(name, "a type", section.findings)
    members = section.last("enum_members")
    fields = [_field(part, names) for part in section.all("variable")]
    if members is not None and fields:
        message = f"the type {name.text} is an enum or has variables, not both"
        members.error("AOS106", message)
    if members is not None:
        return enum_type(name, listed_values(members), section.findings)
    if not fields:
        hint = "Add `enum_members:` or `variable:` lines"
        section.findings.error("AOS105", f"the type {name.text} is empty", name.span, hint)
    return documents.CompoundType(name.text, tuple(field for field in fields if field is not None), name.span)


def _field(part: Part, names: Sequence[str]) -> documents.Field | None:
    declaration = read_declaration(part, "a field", names)
    if declaration is None:
        return None
    rest, low_level = _low_level_type(declaration)
    kind = declaration.type
    if (mark := _ARRAY_MARK.match(rest.text)) is not None:
        kind, rest = f"{kind}[{mark[1]}]", rest.after(mark.end())
    if rest.text.startswith("["):
        size = re.match(r"\[\s*(\d+)\s*\]", rest.text)
        container = f"array<{kind}, {size[1]}>" if size else f"vector<{kind}>"
        hint = f"Write `variable: {container} {declaration.name.text}`"
        part.findings.error("AOS104", f"unexpected {rest.text!r}", rest.span, hint)
        kind, rest = container, rest.after(len(rest.text))
    if rest.text.startswith("="):
        part.findings.warning("AOS127", "an equals sign before a default", rest.span, "It is skipped")
        rest = rest.after(1).strip()
    default = _without_learning_scale(rest)
    snippet = expression(default.snippet(), drop_semicolon=True) if default.text else None
    name = declaration.name
    return documents.Field(
        name=name.text,
        type=kind,
        span=name.span,
        default=snippet,
        low_level_type=low_level.text if low_level is not None else None,
        type_span=declaration.type_text.span,
        low_level_span=low_level.span if low_level is not None else None,
    )


def _low_level_type(declaration: Declaration) -> tuple[Text, Text | None]:
    """Splits the text after the name of an `anyValue` into the rest and the type of `of <low-level type>`."""
    rest = declaration.rest
    match = _LOW_LEVEL_TYPE.search(rest.text) if declaration.type == "anyValue" else None
    if match is None:
        return rest, None
    low_level = Text(match.group(1), rest.after(match.start(1)).span)
    return Text(rest.text[: match.start()] + rest.text[match.end() :], rest.span).strip(), low_level


def _without_learning_scale(rest: Text) -> Text:
    """The default without what AOS's learning planner wants behind it: a scale or `ml_ignore`."""
    match = re.fullmatch(r"(.*\S)\s+(ml_ignore|[\d.]+)", rest.text)
    return Text(match.group(1), rest.span) if match else rest


def _instead_of(rest: str, declaration: Declaration) -> str:
    """Advice on what stands behind the name of a variable."""
    if (sized := re.fullmatch(r"\[\s*(\d+)\s*\]", rest)) is not None:
        return f"Write `array<{declaration.type}, {sized[1]}> {declaration.name.text}`"
    if (value := re.fullmatch(r"=?\s*([-+\w.\"]+);?", rest)) is not None:
        return f"Write `default_value: {value[1]}` on a line of its own"
    return "After the name stands `[]` or `[ENUM]` for an array, or nothing; values go into `code:`"


def _variable(section: Section, names: Sequence[str]) -> documents.StateVariable | None:
    declaration = read_declaration(section, "a variable", names)
    if declaration is None:
        return None
    rest, low_level = _low_level_type(declaration)
    mark = _ARRAY_MARK.fullmatch(rest.text)
    if mark is None and rest.text.lower() not in _ARRAY_WORDS:
        hint = _instead_of(rest.text, declaration)
        section.findings.error("AOS104", f"unexpected {rest.text!r}", rest.span, hint)
    code, default_value = section.last("code"), section.code_of("default_value")
    if code is not None and default_value is not None:
        code.error("AOS106", "a variable has `default_value:` or `code:`, not both")
    keys = section.last("key_types")
    kind, is_array, index_enum = array_type(declaration.type)
    index_span = declaration.type_text.after(declaration.type_text.text.find("[") + 1).strip().span
    if mark is not None:
        index_enum, index_span = mark[1] or index_enum, rest.after(mark.start(1)).span
    return documents.StateVariable(
        name=declaration.name.text,
        type=kind,
        span=declaration.name.span,
        is_array=is_array or mark is not None or _ARRAY_WORDS.get(rest.text.lower(), False),
        is_parameter_value=section.word == "action_parameter",
        default_value=expression(default_value, drop_semicolon=True) if default_value else None,
        default_code=code.code() if code is not None else None,
        key_types=_key_types(keys.value, section.findings) if keys is not None else (),
        low_level_type=low_level.text if low_level is not None else None,
        low_level_span=low_level.span if low_level is not None else None,
        type_span=declaration.type_text.span,
        index_enum=index_enum,
        index_span=index_span if index_enum else None,
        is_mission_parameter=section.word == "mission_parameter",
    )


def _key_types(text: Text, findings: Findings) -> tuple[str, ...]:
    """Enum names and ranges between commas."""
    if not _KEYS.fullmatch(text.text):
        hint = "Write enum names and ranges (start,stop,step) between commas"
        findings.error("AOS104", f"these keys cannot be read: {text.text!r}", text.span, hint)
        return ()
    return tuple(match.group() for match in _KEY.finditer(text.text))


_TYPE_AND_NAME = re.compile(r"(\S.*?)\s+(\S+)")


def read_low_level(sections: Sections, project: str, span: Span) -> LowLevelDocument:
    """The low-level types and constants; what cannot be read is reported and left out."""
    types = [_low_level_kind(section) for section in sections.all("define_type")]
    constants = [_constant(section) for section in sections.all("constant")]
    return LowLevelDocument(
        project,
        span,
        tuple(kind for kind in types if kind is not None),
        tuple(constant for constant in constants if constant is not None),
    )


def _low_level_kind(section: Section) -> LowLevelType | None:
    if not section.value.text:
        section.error("AOS105", "`define_type:` needs a name")
        return None
    if not check_name(section.value, "a low-level type", section.findings):
        return None
    fields = []
    for part in section.all("variable"):
        declared = _type_and_name(part)
        if declared is not None and check_name(declared[1], "a field", section.findings):
            fields.append(Parameter(declared[1].text, declared[0], declared[1].span))
    return LowLevelType(section.value.text, tuple(fields), section.value.span)


def _constant(section: Section) -> LowLevelConstant | None:
    declared = _type_and_name(section)
    code = section.code_of("code")
    if code is None:
        section.error("AOS105", "a low-level constant needs `code:` that sets it")
    if declared is None or code is None:
        return None
    kind, name = declared
    return LowLevelConstant(name.text, kind, code, name.span)


def _type_and_name(part: Part) -> tuple[str, Text] | None:
    match = _TYPE_AND_NAME.fullmatch(part.value.text)
    if match is None:
        span = part.place
        part.findings.error("AOS104", f"`{part.word}:` needs a type and a name", span)
        return None
    return match.group(1), Text(match.group(2), part.value.after(match.start(2)).span)
