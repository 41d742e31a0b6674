"""Variables that are declared and then mentioned nowhere."""

import re
from collections import Counter
from collections.abc import Collection, Iterable

from aos_language.check.models.blocks import all_blocks
from aos_language.findings import Findings
from aos_protocol.documents import AbstractionMapping, Assignment, Environment, SkillModel, Snippet

_WORD = re.compile(r"[A-Za-z_]\w*")


def check_unused_variables(
    environment: Environment, models: Iterable[SkillModel], findings: Findings
) -> None:
    """State variables that no model code names, and that no loop or list of their type's objects takes in.

    A variable's own default is no use of it. Values of parameters are used by being chosen from.
    """
    models = tuple(models)
    defaults = {id(variable.default_code) for variable in environment.variables}
    snippets = (block.snippet for block in all_blocks(environment, models))
    words = _words(snippet for snippet in snippets if id(snippet) not in defaults)
    looped = _looped_types(environment, models)
    of_default = [
        _words((code,) if (code := variable.default_code) else ()) for variable in environment.variables
    ]
    defaults_with = Counter(word for default_words in of_default for word in default_words)
    for variable, own in zip(environment.variables, of_default, strict=True):
        used = (variable.name, f"{variable.type}Objects", f"{variable.type}ObjectsForActions")
        is_used = any(word in words or defaults_with[word] > (word in own) for word in used)
        if variable.is_parameter_value or variable.type in looped or is_used:
            continue
        kind = "mission parameter" if variable.is_mission_parameter else "state variable"
        message = f"no code uses the {kind} {variable.name}"
        findings.warning("AOS133", message, variable.span, "Leave it out, or use it")


def check_unused_locals(
    mapping: AbstractionMapping, reported_to_model: Collection[str], findings: Findings
) -> None:
    """Local variables that no rule, no field of the request and no other code names, model code included."""
    conditions = [rule.condition for rule in mapping.rules if rule.condition is not None]
    conditions += [mapping.stop_when] if mapping.stop_when is not None else []
    used = _words(conditions) | _words(field.value for field in mapping.activation.fields)
    used |= _words(assignment.value for rule in mapping.rules for assignment in rule.assignments)
    for variable in mapping.local_variables:
        others = _words(
            other.code
            for other in mapping.local_variables
            if other is not variable and other.code is not None
        )
        if variable.name not in used | others | {mapping.response_variable, *reported_to_model}:
            message = f"no rule and no field uses the local variable {variable.name}"
            findings.warning("AOS133", message, variable.span, "Leave it out, or use it")


def _words(snippets: Iterable[Snippet]) -> set[str]:
    return {word for snippet in snippets for word in _WORD.findall(snippet.code)}


def _looped_types(environment: Environment, models: Iterable[SkillModel]) -> set[str]:
    blocks: list[tuple[Assignment, ...]] = [environment.initial_belief, environment.extrinsic_changes]
    blocks += [special.code for special in environment.special_states]
    for model in models:
        blocks += [model.precondition, model.rollout_policy, model.execution_time, model.dynamic_model]
        blocks.append(model.state_given_observation)
    return {
        loop.type
        for block in blocks
        for assignment in block
        for loop in (*assignment.over_previous, *assignment.over_next)
    }
