"""The abstraction mapping of a skill that has none written: AOS derives it from the skill document.

The path is the skill's name, its parameters are the fields of the call, and the result's field `response` is
the response. What the model reports as `__observed.NAME` is the result's field NAME.
"""

import keyword
from collections.abc import Collection, Iterator

from aos_language.cpp.keywords import SPECIAL_NAMES
from aos_language.cpp.snippets import Access, Cpp, DeclarationKind, Extent, Mention
from aos_language.cpp.values import value_names
from aos_language.document_code import shared_code_of, snippets_of
from aos_language.local_types import RESERVED_LOCAL_NAMES
from aos_language.observed import reported_numbers
from aos_protocol.diagnostics import Span
from aos_protocol.documents import (
    AbstractionMapping,
    Activation,
    ActivationField,
    Environment,
    LocalSource,
    LocalVariable,
    ResponseRule,
    SkillModel,
    Snippet,
)

RESPONSE_FIELD = "response"

_NO_RESPONSES = frozenset(
    {"AOS", "AOSUtils", "NULL", "false", "nullptr", "state", "state_", "state__", "true"}
)


def derived_mapping(model: SkillModel, environment: Environment | None) -> AbstractionMapping:
    """The mapping of a skill that has only a skill document. Its parts stand at places of that document."""
    numbers = reported_numbers(model)
    used = [number.name for number in numbers]
    variable_names: dict[str, str] = {}
    for parameter in model.parameters:
        variable_names[parameter.name] = _free(parameter.name, used)
        used.append(variable_names[parameter.name])
    response = _free(RESPONSE_FIELD, used)
    locals_ = [
        LocalVariable(
            variable_names[parameter.name],
            LocalSource.PARAMETER,
            parameter.span,
            parameter_path=parameter.name,
            source_span=parameter.span,
        )
        for parameter in model.parameters
    ]
    responses = _responses(model, environment)
    has_text = _has_text_response(model)
    if responses or has_text:
        locals_.append(_of_result(response, RESPONSE_FIELD, model.span))
    for number in numbers:
        span = number.snippet.at(number.extent.start)
        kind = "float[]" if number.is_array else "float"
        locals_.append(_of_result(number.name, number.name, span, kind))
    return AbstractionMapping(
        model.project,
        model.name,
        model.span,
        Activation(
            "skill",
            f"/{model.name}",
            model.span,
            fields=tuple(
                ActivationField(parameter.name, Snippet(variable_names[parameter.name], (parameter.span,)))
                for parameter in model.parameters
            ),
        ),
        rules=tuple(
            ResponseRule(name, Snippet(f'{response} == "{name}"', (span,)), span)
            for name, span in responses.items()
        ),
        response_variable=response if has_text else "",
        local_variables=tuple(locals_),
        is_derived=True,
    )


def sets_response(model: SkillModel) -> Span | None:
    """Returns the place where the model first sets `__moduleResponse`; None where it does not."""
    for snippet, cpp in snippets_of(model.dynamic_model):
        for mention in cpp.mentions:
            if mention.path == ("__moduleResponse",) and mention.assigned is not None:
                return snippet.at(mention.root.start)
    return None


def _free(name: str, used: Collection[str]) -> str:
    """A name for a local variable: the one that is wanted, with underscores behind it where it cannot be."""
    while name in used or name in RESERVED_LOCAL_NAMES or keyword.iskeyword(name):
        name += "_"
    return name


def _of_result(name: str, field: str, span: Span, kind: str = "") -> LocalVariable:
    code = Snippet(f'{name} = getattr(__input, "{field}", None)', (span,))
    return LocalVariable(name, LocalSource.SERVICE_RESPONSE, span, kind, code=code)


def _responses(model: SkillModel, environment: Environment | None) -> dict[str, Span]:
    """Returns the responses that the dynamic model gives and declares nowhere, in the order of the text."""
    known = {*SPECIAL_NAMES, *_NO_RESPONSES, *(parameter.name for parameter in model.parameters)}
    if environment is not None:
        known |= {value for enum in environment.enums for value in enum.values}
        known |= shared_code_of(environment).all_names
    read = list(snippets_of(model.dynamic_model))
    for assignment in model.dynamic_model:
        if (temporary := assignment.temporary) is not None:
            known |= {temporary.name, temporary.enum_name, *temporary.enum_values}
    declared = {declaration.name: declaration.kind for _, cpp in read for declaration in cpp.declarations}
    variables = {name for name, kind in declared.items() if kind is DeclarationKind.VARIABLE}
    variables |= {
        assignment.temporary.name for assignment in model.dynamic_model if assignment.temporary is not None
    }
    found: dict[str, Span] = {}
    # A variable that becomes the response has responses as its values in turn.
    holders = ["__moduleResponse"]
    for holder in holders:
        for snippet, cpp in read:
            for name, offset in _values_of(holder, cpp):
                if name in variables and name not in holders:
                    holders.append(name)
                elif name not in known and name not in declared:
                    found.setdefault(name, snippet.at(offset))
    if not found:
        found = {
            mention.path[0]: snippet.at(mention.extent.start)
            for snippet, cpp, mention in reversed(list(_kept_names(read, declared)))
            if mention.path[0] not in known and mention.path[0] not in declared
        }
    return dict(sorted(found.items(), key=lambda item: item[1]))


def _values_of(variable: str, cpp: Cpp) -> Iterator[tuple[str, int]]:
    """The lone names that a variable is set to, with their offsets in the snippet."""
    extents = [declaration.initial for declaration in cpp.declarations if declaration.name == variable]
    extents += [mention.assigned for mention in cpp.mentions if mention.path == (variable,)]
    for extent in extents:
        if extent is not None:
            text = cpp.text(extent)
            yield from ((name, extent.start + offset) for name, offset in value_names(text))


def _kept_names(
    read: list[tuple[Snippet, Cpp]], declared: Collection[str]
) -> Iterator[tuple[Snippet, Cpp, Mention]]:
    """The lone names that are put into what `__moduleResponse` is taken out of: a list, a map, a lambda."""
    sources = {
        mention.path[0]
        for _, cpp in read
        for extent in _assigned_to("__moduleResponse", cpp)
        for mention in _within(extent, cpp)
        if mention.path[0] in declared
    }
    for source in sources:
        for snippet, cpp in read:
            for extent in _assigned_to(source, cpp):
                names = (each for each in _within(extent, cpp) if len(each.path) == 1)
                yield from ((snippet, cpp, each) for each in names if each.access is Access.READ)


def _assigned_to(variable: str, cpp: Cpp) -> Iterator[Extent]:
    """The extents of what a variable or a part of it is set to, and of the calls of its methods."""
    extents = [declaration.initial for declaration in cpp.declarations if declaration.name == variable]
    extents += [mention.assigned for mention in cpp.mentions if mention.path[0] == variable]
    extents += [call.extent for call in cpp.calls if call.name[:1] == (variable,) and len(call.name) > 1]
    yield from (extent for extent in extents if extent is not None)


def _within(extent: Extent, cpp: Cpp) -> Iterator[Mention]:
    for mention in cpp.mentions:
        if extent.start <= mention.extent.start < extent.end:
            yield mention


def _has_text_response(model: SkillModel) -> bool:
    return any(
        mention.path[0] == "__moduleResponseStr"
        for _, cpp in snippets_of(model.dynamic_model)
        for mention in cpp.mentions
    )
