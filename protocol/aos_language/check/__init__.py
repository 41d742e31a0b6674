"""The rules across documents.

`models` has those of the C++ of environment and skills, `mappings` those of the Python of mappings. The
files here look at both, or at neither: names, their types and meanings, endings, monitors, mission
parameters, constraints, what skill and mapping say to each other, and what nothing mentions.
"""

from aos_language.assembly import Assembly
from aos_language.check.declarations import (
    check_environment_names,
    check_mission_parameters,
    check_skill_declarations,
)
from aos_language.check.endings import check_endings, check_goals
from aos_language.check.mappings.mapping_code import check_low_level, check_mapping
from aos_language.check.mappings.shared_mapping_code import check_shared_mapping_code
from aos_language.check.mappings.stop_when import check_stop_when
from aos_language.check.models.decimals import check_decimals
from aos_language.check.models.defaults import check_defaults
from aos_language.check.models.model_code import check_environment_code, check_skill_code
from aos_language.check.models.observed_numbers import (
    check_environment_reports,
    check_given_observation,
    check_observed_numbers,
    check_reported_variables,
    check_reports,
    names_in_given_observation,
)
from aos_language.check.models.preconditions import check_precondition
from aos_language.check.models.shared_code import check_shared_code, check_shared_names_are_used
from aos_language.check.monitors import check_monitors
from aos_language.check.responses import check_responses
from aos_language.check.scope import Scope
from aos_language.check.unused import check_unused_locals, check_unused_variables
from aos_language.findings import Findings
from aos_language.local_types import reported_variables
from aos_language.observed import reported_numbers
from aos_protocol.documents import AbstractionMapping

__all__ = ["check"]


def check(assembly: Assembly, findings: Findings) -> None:
    """Reports all that the documents contradict; what is missing is left to `assembly`."""
    scope = Scope.of(assembly)
    is_whole = not findings.has_errors  # What could not be read may have used a variable.
    if assembly.environment is not None:
        check_environment_names(assembly.environment, scope, findings)
        check_shared_code(assembly.environment, scope, findings)
        check_environment_code(assembly.environment, scope, findings)
        check_defaults(assembly.environment, findings)
        check_mission_parameters(assembly.environment, scope, findings)
        check_endings(assembly.environment, findings)
        check_environment_reports(assembly.environment, findings)
    for name, model in assembly.models.items():
        if assembly.environment is not None:
            check_skill_declarations(model, scope, findings)
        check_skill_code(model, scope, findings)
        check_reports(model, findings)
        check_precondition(model, findings)
        if name in assembly.mappings:
            check_responses(model, assembly.mappings[name], scope, findings, is_whole=is_whole)
            check_given_observation(model, assembly.mappings[name], findings)
            check_observed_numbers(model, assembly.mappings[name], assembly.environment, findings)
    for name, mapping in assembly.mappings.items():
        before = len(findings)
        check_mapping(mapping, assembly.models.get(name), scope, findings, is_whole=is_whole)
        check_stop_when(mapping, assembly.models.get(name), scope, findings, is_whole=is_whole)
        is_sound = len(findings) == before
        if assembly.environment is not None:
            check_reported_variables(mapping, assembly.environment, findings)
        if is_whole and is_sound and not mapping.is_derived:
            check_unused_locals(mapping, _reported_to_model(mapping, name, assembly), findings)
    check_monitors(assembly, scope, findings, is_whole=is_whole)
    mappings = (*assembly.mappings.values(), *assembly.monitors.values())
    if assembly.low_level is not None:
        check_low_level(assembly.low_level, mappings, scope, findings)
    if scope.shared_mapping_code is not None:
        check_shared_mapping_code(scope.shared_mapping_code, mappings, scope, findings)
    if is_whole and assembly.environment is not None:
        check_goals(assembly.environment, assembly.models.values(), findings)
        check_decimals(assembly.environment, scope, findings)
        check_shared_names_are_used(assembly.environment, assembly.models.values(), findings)
        check_unused_variables(assembly.environment, assembly.models.values(), findings)


def _reported_to_model(mapping: AbstractionMapping, name: str, assembly: Assembly) -> frozenset[str]:
    """The names of local variables that an update of the belief uses."""
    model, environment = assembly.models.get(name), assembly.environment
    named = names_in_given_observation(model) if model is not None else frozenset()
    if model is not None:
        named = named.union(number.name for number in reported_numbers(model))
    return named.union(reported_variables(mapping, environment) if environment is not None else ())
