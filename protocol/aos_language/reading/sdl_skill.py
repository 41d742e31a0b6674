"""The skill document (`.sd`)."""

from aos_language.reading.document import check_penalty
from aos_language.reading.sdl_declaration import read_declaration, read_number
from aos_language.reading.sdl_sections import Sections
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Parameter, SkillModel


def read_skill(sections: Sections, project: str, name: str, span: Span) -> SkillModel:
    """The skill's model; what cannot be read of it is reported and left out."""
    parameters = []
    for section in sections.all("parameter"):
        declaration = read_declaration(section, "a parameter")
        if declaration is None:
            continue
        if declaration.rest.text:
            message = f"unexpected {declaration.rest.text!r} after the parameter"
            sections.findings.error("AOS104", message, declaration.rest.span)
        name_text, kind = declaration.name, declaration.type
        parameters.append(Parameter(name_text.text, kind, name_text.span, declaration.type_text.span))
    penalty = sections.last("violate_penalty")
    number = read_number(penalty) if penalty is not None else 0.0
    if penalty is not None and number:
        check_penalty(name, number, penalty.value.span, sections.findings)
    if not sections.all("dynamic_model"):
        sections.findings.error("AOS105", f"the skill {name} lacks `dynamic_model:`", sections.span)
    return SkillModel(
        project=project,
        name=name,
        span=span,
        parameters=tuple(parameters),
        possible_parameters=sections.block("available_parameters_code"),
        precondition=sections.block("precondition"),
        rollout_policy=sections.block("rollout_policy"),
        violation_penalty=-1.0 if number is None else number,
        execution_time=sections.block("execution_time"),
        dynamic_model=sections.block("dynamic_model"),
        state_given_observation=sections.block("state_given_observation"),
    )
