"""The check that the documents' names can be names in C++."""

from collections.abc import Iterator

from aos_language.cpp.keywords import CPP_KEYWORDS
from aos_language.document_code import shared_code_of
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Environment, Project
from aos_solver.emission.lowering.code import sections_of

_OF_THE_LANGUAGE = frozenset({
    "AOS", "AOSUtils", "EOF", "INFINITY", "NAN", "NULL", "anyValue", "aos", "errno", "state", "state_",
    "state__", "state___", "std",
})  # fmt: skip
_OF_NAMESPACES = frozenset({"model"})
"""No type can have these names, and everything else can."""
_OF_EMITTED_SKILLS = frozenset({
    "execution_time", "given_observation",
    "has_alike_groundings", "has_certain_rewards", "has_text_response", "locals", "make_groundings",
    "is_monitor", "next_state", "number_count",
    "possible_parameters", "precondition", "read_locals", "respond", "response_names", "rollout_policy",
    "violation_penalty",
})  # fmt: skip
_OF_EMITTED_ENVIRONMENTS = frozenset({
    "extrinsic_changes", "has_extrinsic_changes", "initial_belief", "is_one_state", "name_of",
    "print_state", "special_states", "state_heuristic", "with_action", "with_skill",
})  # fmt: skip


def check_names(project: Project, findings: Findings) -> None:
    """Reports AOS126 for every declared name that C++ or the emitted model needs for itself."""
    global_names = _OF_EMITTED_SKILLS | _OF_EMITTED_ENVIRONMENTS
    for enum in project.environment.enums:
        for value in enum.values:
            _check(value, enum.span, findings, global_names)
    for name, span in _shared_names(project.environment):
        _check(name, span, findings, global_names | _OF_NAMESPACES)
    for name, span in _type_names(project.environment):
        _check(name, span, findings, global_names | _OF_NAMESPACES)
    for name, span in _member_names(project):
        _check(name, span, findings, frozenset())
    for mapping in (*(skill.mapping for skill in project.skills), *project.monitors):
        for rule in mapping.rules:
            _check(rule.response, rule.span, findings, _OF_EMITTED_SKILLS)


def _shared_names(environment: Environment) -> Iterator[tuple[str, Span]]:
    if (snippet := environment.shared_code) is not None:
        shared = shared_code_of(environment)
        for item in (*shared.names, *shared.functions):
            if item.name:
                yield item.name, snippet.at(item.name_extent.start)


def _type_names(environment: Environment) -> Iterator[tuple[str, Span]]:
    yield from ((enum.name, enum.span) for enum in environment.enums)
    yield from ((compound.name, compound.span) for compound in environment.compounds)


def _member_names(project: Project) -> Iterator[tuple[str, Span]]:
    environment = project.environment
    for compound in environment.compounds:
        yield from ((field.name, field.span) for field in compound.fields)
    yield from ((variable.name, variable.span) for variable in environment.variables)
    if project.low_level is not None:
        yield from ((constant.name, constant.span) for constant in project.low_level.constants)
    yield from ((monitor.name, monitor.span) for monitor in project.environment.monitors)
    for skill in project.skills:
        yield skill.name, skill.model.span
        yield from ((parameter.name, parameter.span) for parameter in skill.model.parameters)
    for block in (block for _, section in sections_of(project) for block in section):
        if (temporary := block.temporary) is not None:
            names = (temporary.name, temporary.enum_name, *temporary.enum_values)
            yield from ((name, temporary.span) for name in names if name)
        yield from ((loop.item, loop.span) for loop in (*block.over_previous, *block.over_next))


def _check(name: str, span: Span, findings: Findings, ours: frozenset[str]) -> None:
    if not (name.isascii() and name.isidentifier()):
        findings.error("AOS126", f"`{name}` is no name in C++", span, "Use letters, digits and underscores")
    elif name in CPP_KEYWORDS or name in _OF_THE_LANGUAGE:
        findings.error("AOS126", f"`{name}` means something else in model code", span, "Choose another name")
    elif name in ours or name.startswith("aos_"):
        findings.error("AOS126", f"the emitted model uses the name `{name}`", span, "Choose another name")
