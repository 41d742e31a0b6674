"""Local variables of a mapping against model code: numbers that it reports, and what an observation tells."""

from collections.abc import Iterator

from aos_language.check.models.blocks import (
    DYNAMIC,
    Block,
    environment_blocks,
    given_observation_blocks,
    read_block,
    skill_blocks,
)
from aos_language.findings import Findings
from aos_language.local_types import local_type, local_type_text, reported_variables
from aos_language.observed import OBSERVED, ReportedNumber, misuses_of, reported_numbers, reports_in
from aos_protocol.documents import AbstractionMapping, Environment, LocalVariable, SkillModel

_NUMBERS = ("bool", "int", "float", "double")


def check_environment_reports(environment: Environment, findings: Findings) -> None:
    """Reports AOS138 for each use of `__observed` in an environment document, which reports nothing."""
    _check_other_sections(environment_blocks(environment), findings)


def check_reports(model: SkillModel, findings: Findings) -> None:
    """Reports AOS138 for everything but reports of draws in the dynamic model."""
    blocks = list(skill_blocks(model))
    _check_other_sections((block for block in blocks if block.role is not DYNAMIC), findings)
    kinds: dict[str, bool] = {}
    for block in blocks:
        if block.role is not DYNAMIC:
            continue
        cpp = read_block(block)
        for misuse in misuses_of(cpp):
            span = block.snippet.at(misuse.extent.start)
            findings.error("AOS138", misuse.message, span, misuse.hint)
        for report in reports_in(cpp):
            if kinds.setdefault(report.name, report.is_array) != report.is_array:
                extent = report.mention.extent
                message = f"`{OBSERVED}.{report.name}` is reported as one number and as an array"
                hint = "Choose another name for one of them"
                findings.error("AOS138", message, block.snippet.at(extent.start), hint)


def check_observed_numbers(
    model: SkillModel, mapping: AbstractionMapping, environment: Environment | None, findings: Findings
) -> None:
    """Reports AOS136 for each number that the mapping cannot give."""
    variables = {variable.name: variable for variable in mapping.local_variables}
    reported = reported_variables(mapping, environment) if environment is not None else ()
    for number in reported_numbers(model):
        span = number.snippet.at(number.extent.start)
        variable = variables.get(number.name)
        if variable is None:
            message = f"the abstraction mapping of {model.name} has no local variable `{number.name}`"
            otherwise = f"Give it one, of type {_wanted(number)}"
            findings.unknown(number.name, variables, message, span, otherwise, code="AOS136")
        elif not _fits(number, variable):
            kind = f"is of type {variable.type}" if variable.type else "has no type"
            message = f"the local variable {variable.name} {kind}, and model code reports {_what(number)}"
            findings.error("AOS136", message, variable.span, f"Give it the type {_wanted(number)}")
        elif number.name in reported:
            message = f"{variable.name} is reported with noise, and would set a state variable of its name"
            hint = "A local variable with the name and type of a state variable tells its value: rename it"
            findings.error("AOS136", message, variable.span, hint)


def _fits(number: ReportedNumber, variable: LocalVariable) -> bool:
    kind = local_type(variable.type)
    return kind is not None and kind.element in _NUMBERS and kind.is_array == number.is_array


def _what(number: ReportedNumber) -> str:
    return "an array of numbers" if number.is_array else "a number"


def _wanted(number: ReportedNumber) -> str:
    return "float[], or another array of numbers" if number.is_array else "float, or another type of number"


def _check_other_sections(blocks: Iterator[Block], findings: Findings) -> None:
    for block in blocks:
        for mention in read_block(block).mentions:
            if mention.path[0] == OBSERVED:
                span = block.snippet.at(mention.root.start)
                message = f"`{OBSERVED}` in {block.role.title}"
                findings.error("AOS138", message, span, "Only the dynamic model of a skill reports numbers")


def check_given_observation(model: SkillModel, mapping: AbstractionMapping, findings: Findings) -> None:
    """Reports AOS110 for each local variable that the code names and that has no type of C++."""
    locals_ = {variable.name: variable for variable in mapping.local_variables}
    for block in given_observation_blocks(model):
        cpp = read_block(block)
        own = cpp.declared | block.names.keys()
        for mention in cpp.mentions:
            variable = locals_.get(mention.path[0])
            if variable is None or variable.name in own or local_type(variable.type) is not None:
                continue
            kind = f"the type {variable.type}" if variable.type else "no type"
            message = f"the local variable `{variable.name}` has {kind}, so model code cannot use it"
            hint = f"Give it one in the abstraction mapping: {local_type_text()}"
            span = block.snippet.at(mention.root.start)
            findings.error("AOS110", message, span, hint)


def check_reported_variables(
    mapping: AbstractionMapping, environment: Environment, findings: Findings
) -> None:
    """Reports AOS134 for each local variable that sets a state variable by its name alone, perhaps by
    accident."""
    for variable in mapping.local_variables:
        if variable.name in reported_variables(mapping, environment):
            message = f"after each run the state variable {variable.name} is what this local variable is"
            hint = "They have the same name and type; if that is not meant, choose another name"
            findings.remark("AOS134", message, variable.span, hint)


def names_in_given_observation(model: SkillModel) -> frozenset[str]:
    """All names that the code mentions."""
    blocks = given_observation_blocks(model)
    return frozenset(mention.path[0] for block in blocks for mention in read_block(block).mentions)
