"""Monitors: each has a model in the environment document and a mapping, which say the same responses."""

from aos_language.assembly import Assembly
from aos_language.check.mappings.mapping_code import check_mapping
from aos_language.check.mappings.stop_when import check_stop_when, tells_of_stops
from aos_language.check.responses import check_responses
from aos_language.check.scope import Scope
from aos_language.check.unused import check_unused_locals
from aos_language.findings import Findings
from aos_protocol.documents import AbstractionMapping, LocalSource, MonitorModel, SkillModel, Snippet


def check_monitors(assembly: Assembly, scope: Scope, findings: Findings, *, is_whole: bool) -> None:
    """Reports AOS114 for a monitor without one of its halves, AOS111 for names that are taken, AOS106 for
    what only a skill can have, and AOS116 and AOS117 for responses that one half alone knows."""
    models = _models(assembly, findings)
    first: dict[str, AbstractionMapping] = {}
    for mapping in assembly.monitors.values():
        before = len(findings)
        _check_form(mapping, findings)
        check_mapping(mapping, None, scope, findings, is_whole=is_whole)
        check_stop_when(mapping, None, scope, findings, is_whole=is_whole)
        if is_whole and len(findings) == before:
            check_unused_locals(mapping, (), findings)
        name, span = mapping.monitor, mapping.activation.span
        if name in first:
            hint = f"The first is {first[name].span.file}"
            findings.error("AOS111", f"a second mapping of the monitor {name}", span, hint)
        elif name in models:
            check_responses(_as_skill(models[name]), mapping, scope, findings, is_whole=is_whole)
        elif assembly.environment is not None:
            message = f"the environment document has no monitor `{name}`"
            otherwise = f"Add `monitor: {name}` with the code that gives its response from `state`"
            findings.unknown(name, models, message, span, otherwise, code="AOS114")
        first.setdefault(name, mapping)
        if is_whole and mapping.stop_when is not None:
            _check_stopped(mapping.stop_when, assembly, findings)
    for name in models if is_whole else ():
        if name not in first and first.keys() <= models.keys():  # Else it was meant by another name.
            hint = f"Add {name}.am with `monitor: {name}`, or take the model out"
            message = f"the monitor {name} has no abstraction mapping"
            findings.error("AOS114", message, models[name].span, hint)


def _check_stopped(stop_when: Snippet, assembly: Assembly, findings: Findings) -> None:
    """Warns where it can stop skills whose mappings say nothing of a stop."""
    silent = sorted(name for name, mapping in assembly.mappings.items() if not tells_of_stops(mapping))
    if silent:
        message = f"no rule says what is observed where this stops {', '.join(silent)}"
        hint = (
            "Give the mapping a rule for `__skill_status == 'stopped'`: else nobody knows what the skill did"
        )
        findings.warning("AOS116", message, stop_when.span, hint)


def _models(assembly: Assembly, findings: Findings) -> dict[str, MonitorModel]:
    models: dict[str, MonitorModel] = {}
    for model in assembly.environment.monitors if assembly.environment is not None else ():
        if model.name in models:
            hint = f"The first is at {models[model.name].span}"
            findings.error("AOS111", f"a second monitor {model.name}", model.span, hint)
        elif model.name in assembly.models:
            message = f"a skill is called {model.name} too"
            findings.error("AOS111", message, model.span, "Choose another name for the monitor")
        models.setdefault(model.name, model)
    return models


def _as_skill(model: MonitorModel) -> SkillModel:
    """A monitor's model in the place where a skill says what it reports."""
    return SkillModel("", model.name, model.span, dynamic_model=model.code)


def _check_form(mapping: AbstractionMapping, findings: Findings) -> None:
    """Reports what a monitor lacks, and what only a skill can have."""
    for variable in mapping.local_variables:
        if variable.source is not LocalSource.TOPIC:
            source = "parameters" if variable.source is LocalSource.PARAMETER else "result"
            message = f"`{variable.name}` is of a call's {source}, and a monitor calls nothing"
            findings.error("AOS106", message, variable.span, "Take it from a topic")
    if not any(variable.source is LocalSource.TOPIC for variable in mapping.local_variables):
        hint = "Add a local variable with `topic:`"
        findings.error("AOS105", f"the monitor {mapping.monitor} listens to no topic", mapping.span, hint)
    if mapping.response_variable or not mapping.rules:
        span = mapping.response_variable_span or mapping.span
        hint = "Give it `response:` with `response_rule:`"
        findings.error("AOS105", f"the monitor {mapping.monitor} has no response rules", span, hint)
    for rule in mapping.rules:
        for assignment in rule.assignments:
            message = "a monitor gives no low-level values"
            findings.error("AOS106", message, assignment.span, "A skill's rules do")
