"""Code for a state given an observation against the local variables of the mapping, which it may name."""

from aos_language.check.models.blocks import given_observation_blocks, read_block
from aos_language.findings import Findings
from aos_language.local_types import local_type, local_type_text, reported_variables
from aos_protocol.documents import AbstractionMapping, Environment, SkillModel


def check_given_observation(model: SkillModel, mapping: AbstractionMapping, findings: Findings) -> None:
    """Reports AOS110 for each local variable that the code names and that has no type of C++."""
    locals_ = {variable.name: variable for variable in mapping.local_variables}
    for block in given_observation_blocks(model):
        cpp = read_block(block)
        own = {declaration.name for declaration in cpp.declarations} | block.names.keys()
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
