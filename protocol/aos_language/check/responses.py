"""The responses that a skill document reports against those that its abstraction mapping gives.

A number in the place of a response or a text is told, too. C++ takes both in silence: the first as a place in
the list of responses, the second as one letter.
"""

import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches

from aos_language.check.models.blocks import DYNAMIC, Block, assignment_blocks, read_block
from aos_language.check.scope import Scope
from aos_language.cpp.keywords import SPECIAL_NAMES, STATES
from aos_language.cpp.snippets import Access, Cpp, DeclarationKind, Mention
from aos_language.cpp.values import values
from aos_language.derived_mapping import sets_response
from aos_language.findings import Findings
from aos_protocol.documents import DEFAULT_RESPONSE, AbstractionMapping, SkillModel
from aos_protocol.spelling import quoted

_RESPONSES = frozenset({"__moduleResponse", "__moduleResponseStr"})
_KNOWN_TO_CPP = frozenset({"AOS", "AOSUtils", "false", "nullptr", "NULL", "this", "true"})


def check_responses(
    model: SkillModel, mapping: AbstractionMapping, scope: Scope, findings: Findings, *, is_whole: bool
) -> None:
    """Both directions: a response that no rule gives, and a rule whose response no code produces.

    Where the documents are not read as a `whole`, what seems to be missing may stand in the rest.
    """
    parameters = {parameter.name: parameter.type for parameter in model.parameters}
    blocks = list(assignment_blocks(DYNAMIC, model.dynamic_model, parameters))
    read = [(block, read_block(block)) for block in blocks]
    if any(cpp.faults for _, cpp in read):
        return
    known = _known_names(model, scope, read)
    given = tuple(dict.fromkeys(rule.response for rule in mapping.rules))
    check_response_values(given, read, scope, findings)
    enum_values, others = _own_names(model, read)
    for block, mention, may_be_one in _assigned_names(read):
        name = mention.path[0]
        span = block.snippet.at(mention.root.start)
        if name in given and name in enum_values | others:
            message = f"`{name}` is declared in this skill too, and hides the response"
            report = findings.error if name in enum_values else findings.warning
            report("AOS126", message, span, "Choose another name for one of them")
        if name in given or name in known:
            continue
        if mapping.is_derived or not may_be_one:
            names = sorted(known | set(given))
            findings.unknown(name, names, f"unknown name `{name}`", span, "It stands in a condition")
            continue
        message = f"the abstraction mapping of {model.name} has no response `{name}`"
        otherwise = f"It has {quoted(given)}" if given else "Add a response with its rule to the mapping"
        findings.unknown(name, given, message, span, otherwise, code="AOS116")
    if mapping.is_derived and not given and (place := sets_response(model)) is not None:
        message = f"the responses of {model.name} cannot be told from its code"
        hint = f"Assign names without quotes to __moduleResponse, or write a mapping: {model.name}.am"
        findings.error("AOS114", message, place, hint)
    if is_whole and _check_any_response(model, mapping, read, findings):
        return
    _check_text_response(model, mapping, read, findings)
    mentioned = {mention.path[0] for _, cpp in read for mention in cpp.mentions if len(mention.path) == 1}
    for rule in mapping.rules:
        if rule.response in scope.enum_values:
            message = f"the response {rule.response} has the name of an enum value"
            findings.warning(
                "AOS126",
                message,
                rule.span,
                "Compared with the state or assigned to it, it is the value, else the response",
            )
        if rule.response not in mentioned and model.dynamic_model and not mapping.response_variable:
            title = (
                f"model of the monitor {model.name}" if mapping.monitor else f"skill document of {model.name}"
            )
            message = f"the {title} never produces the response {rule.response}"
            hint = "When it comes, the belief has no explanation for it"
            report = findings.error if mapping.monitor else findings.warning
            report("AOS117", message, rule.span, hint)


def _check_any_response(
    model: SkillModel, mapping: AbstractionMapping, read: list[tuple[Block, Cpp]], findings: Findings
) -> bool:
    """Reports AOS117 for a model that never says what comes back, where the mapping always gives a word: True
    if so.

    Such a model gives `DefaultObservation` in every run, so that what really comes is impossible.
    """
    mentioned = {mention.path[0] for _, cpp in read for mention in cpp.mentions}
    given = tuple(dict.fromkeys(rule.response for rule in mapping.rules))
    # A name that is nearly one of the two is told where it stands.
    is_set = any(get_close_matches(name, _RESPONSES, n=1, cutoff=0.85) for name in mentioned)
    if is_set or DEFAULT_RESPONSE in given or not (given or mapping.response_variable):
        return False
    word = "__moduleResponseStr" if mapping.response_variable else "__moduleResponse"
    hint = f"Set it: the abstraction mapping gives {quoted(given)}"
    if mapping.response_variable:
        hint = f"Set it: the abstraction mapping gives the text of {mapping.response_variable}"
    elif len(given) == 1:
        hint = f"Add `__moduleResponse = {given[0]};`"
    span = read[-1][0].snippet.span if read else model.span
    title = f"monitor {model.name}" if mapping.monitor else f"dynamic model of {model.name}"
    message = f"the {title} never sets {word}, so that every response is impossible"
    report = findings.error if mapping.monitor else findings.warning
    report("AOS117", message, span, hint)
    return True


def _check_text_response(
    model: SkillModel, mapping: AbstractionMapping, read: list[tuple[Block, Cpp]], findings: Findings
) -> None:
    writes = [
        (block, mention)
        for block, cpp in read
        for mention in cpp.mentions
        if mention.path[0] == "__moduleResponseStr"
    ]
    if writes and not mapping.response_variable:
        block, mention = writes[0]
        span = block.snippet.at(mention.root.start)
        hint = "Name the local variable that holds it with `response_local_variable:`"
        message = f"the abstraction mapping of {model.name} gives no text response"
        findings.warning("AOS116", message, span, hint)
    roots = {mention.path[0] for _, cpp in read for mention in cpp.mentions}
    is_mistyped = any(get_close_matches("__moduleResponseStr", roots, n=1, cutoff=0.85))
    if mapping.response_variable and not writes and model.dynamic_model and not is_mistyped:
        message = f"the skill document of {model.name} never sets __moduleResponseStr"
        findings.warning("AOS117", message, mapping.response_variable_span or mapping.span)


def _assigned_names(read: list[tuple[Block, Cpp]]) -> Iterator[tuple[Block, Mention, bool]]:
    """The lone names in what is assigned to `__moduleResponse`, and whether each may be a response: where all
    that it can be is names, the others are in conditions."""
    for block, cpp in read:
        extents = [
            mention.assigned
            for mention in cpp.mentions
            if mention.path == ("__moduleResponse",) and mention.assigned is not None
        ]
        for extent in extents:
            can_be = [each for each in values(cpp.text(extent)) if each[2] >= 0]
            places = {extent.start + offset for _, _, offset in can_be}
            is_told = all(kind == "identifier" for kind, _, _ in can_be)
            for mention in cpp.mentions:
                is_name = len(mention.path) == 1 and mention.access is Access.READ
                at = mention.extent.start
                if is_name and extent.start <= at < extent.end:
                    yield block, mention, at in places or not is_told


def _own_names(model: SkillModel, read: list[tuple[Block, Cpp]]) -> tuple[set[str], set[str]]:
    """The values of the enums that the dynamic model declares, and the names of its variables."""
    temporaries = [
        assignment.temporary for assignment in model.dynamic_model if assignment.temporary is not None
    ]
    of_enums = {value for temporary in temporaries for value in temporary.enum_values}
    variables = {temporary.name for temporary in temporaries}
    for _, cpp in read:
        for declaration in cpp.declarations:
            is_value = declaration.kind is DeclarationKind.ENUMERATOR
            (of_enums if is_value else variables).add(declaration.name)
    return of_enums, variables


def _known_names(model: SkillModel, scope: Scope, read: list[tuple[Block, Cpp]]) -> set[str]:
    known = {*SPECIAL_NAMES, *_KNOWN_TO_CPP, *STATES, *scope.enum_values, *scope.enums}
    known |= scope.shared.all_names
    known |= {*scope.low_level_names, *(parameter.name for parameter in model.parameters)}
    blocks = (model.precondition, model.execution_time, model.dynamic_model)
    for assignment in (assignment for block in blocks for assignment in block):
        if assignment.temporary is not None:
            temporary = assignment.temporary
            known |= {temporary.name, temporary.enum_name, *temporary.enum_values}
    for block, cpp in read:
        known |= {*block.names, *(declaration.name for declaration in cpp.declarations)}
    return known


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
