"""Types and variables of the environment."""

import re
from collections.abc import Iterable

from aos_language.cpp.snippets import read_cpp
from aos_language.document_code import shared_code_of, snippets_of
from aos_language.findings import Findings
from aos_language.local_types import reported_variables
from aos_protocol.documents import Environment, Project, StateVariable
from aos_solver.emission.lowering.capacities import Capacities
from aos_solver.emission.lowering.code import BELIEF, Pieces, sections_of
from aos_solver.emission.lowering.types import Types, ordered_compounds
from aos_solver.emission.lowering.writes import Changes, changes_of, drawing_defaults
from aos_solver.emission.program import Compound, Field, ObjectList, ParameterValues, Variable
from aos_solver.emission.rewriting.rewrite import Rewriting

_SET_NUMBER = re.compile(r"(?:state\.\w+\s*=\s*)?(\d+)\s*;?")


def capacities_of(project: Project) -> Capacities:
    """The capacity of every vector, from all code of the project."""
    environment = project.environment
    shared = shared_code_of(environment)
    capacities = Capacities(
        shared.changing,
        shared.whole_numbers | _constant_numbers(project),
        [(variable.name, _type_of(variable)) for variable in environment.variables],
        {one.name: [(field.name, field.type) for field in one.fields] for one in environment.compounds},
    )
    capacities.read_code([shared.cpp])
    for compound in environment.compounds:
        for field in compound.fields:
            if field.default is not None:
                capacities.read_default(field.name, field.default.code)
    for variable in environment.variables:
        if variable.default_value is not None:
            capacities.read_default(variable.name, variable.default_value.code)
        if variable.default_code is not None:
            capacities.read_code([read_cpp(variable.default_code.code)], sets_up=True)
    for skill in project.skills:
        for name in reported_variables(skill.mapping, environment):
            capacities.fill_by_report(name)
    for phase, assignments in sections_of(project):
        capacities.read_code((cpp for _, cpp in snippets_of(assignments)), sets_up=phase is BELIEF)
    return capacities


def _type_of(variable: StateVariable) -> str:
    return f"{variable.type}[{variable.index_enum}]" if variable.is_array else variable.type


def _constant_numbers(project: Project) -> dict[str, str]:
    """The variables that are whole numbers and that nothing but their default sets."""
    changed = changes_of(project).variables
    numbers: dict[str, str] = {}
    for variable in project.environment.variables:
        default = variable.default_value or variable.default_code
        if default is not None and variable.name not in changed and not variable.is_mission_parameter:
            number = _SET_NUMBER.fullmatch(default.code.strip())
            numbers |= {variable.name: number[1]} if number is not None else {}
    return numbers


def member_names(project: Project) -> frozenset[str]:
    """All names of variables, fields and parameters."""
    environment = project.environment
    names = {variable.name for variable in environment.variables}
    names |= {field.name for compound in environment.compounds for field in compound.fields}
    return frozenset(names | {p.name for skill in project.skills for p in skill.model.parameters})


def lower_compounds(
    environment: Environment, types: Types, pieces: Pieces, outside: Rewriting
) -> tuple[Compound, ...]:
    """The compounds, each behind those that it holds."""
    compounds = []
    for compound in ordered_compounds(environment.compounds):
        fields = tuple(
            Field(
                field.name,
                types.stored(field.type, field.name, field.span),
                pieces.expression(field.default, outside) if field.default is not None else None,
            )
            for field in compound.fields
        )
        compounds.append(Compound(compound.name, fields))
    return tuple(compounds)


def lower_variables(
    project: Project,
    changes: Changes,
    types: Types,
    pieces: Pieces,
    outside: Rewriting,
    irrelevant: frozenset[str],
    findings: Findings,
) -> tuple[Variable, ...]:
    """The state variables in their order, behind the mission parameters, which are there before them.

    AOS124 for a parameter value that is drawn at random.
    """
    environment = project.environment
    drawn = frozenset(drawing_defaults(environment))
    later = changes_of(project, after_start=True)
    lowered = []
    for variable in sorted(environment.variables, key=lambda variable: not variable.is_mission_parameter):
        if variable.is_parameter_value and variable.name in drawn:
            message = f"{variable.name} is a value of an action parameter and drawn at random"
            hint = "Actions are the same in all states; let an initial belief draw another variable"
            findings.error("AOS124", message, variable.span, hint)
        axes = tuple(types.axis(key, variable.span) for key in variable.key_types)
        stored = types.stored(_type_of(variable), variable.name, variable.span)
        if axes:
            stored = f"aos::Table<{stored}, {', '.join(axis.type for axis in axes)}>"
        value, code = variable.default_value, variable.default_code
        is_walked = variable.type in changes.object_types and not variable.is_constant
        is_changed = is_walked or variable.name in changes.variables
        lowered.append(
            Variable(
                name=variable.name,
                type=stored,
                is_constant=variable.is_mission_parameter or not is_changed,
                is_parameter_value=variable.is_parameter_value,
                default_value=pieces.expression(value, outside) if value is not None else None,
                default_code=pieces.code(code, outside) if code is not None else None,
                axes=axes,
                is_relevant=variable.name not in irrelevant,
                is_fixed=variable.name not in later.variables and variable.type not in later.object_types,
                is_mission_parameter=variable.is_mission_parameter,
            )
        )
    return tuple(lowered)


def object_lists(environment: Environment, changes: Changes) -> tuple[ObjectList, ...]:
    """`state.<Type>Objects` for the compound types that are walked over."""
    return tuple(
        ObjectList(
            name,
            tuple(
                variable.name
                for variable in environment.variables
                if variable.type == name and _is_plain(variable) and not variable.is_constant
            ),
        )
        for name in sorted(changes.object_types)
    )


def values_for(type_name: str, environment: Environment) -> ParameterValues:
    """The values of a parameter that nothing lists: as below, or all of an enum that has none so."""
    values = {enum.name: enum.values for enum in environment.enums}.get(type_name, ())
    declared = parameter_values(environment.variables, type_name)
    return declared if declared.variables else ParameterValues(type_name, (), values)


def parameter_values(variables: Iterable[StateVariable], type_name: str) -> ParameterValues:
    """The values for parameters of exactly this type, in the order of their names."""
    names = [v.name for v in variables if v.is_parameter_value and v.type == type_name and _is_plain(v)]
    return ParameterValues(type_name, tuple(sorted(names)))


def _is_plain(variable: StateVariable) -> bool:
    return not variable.is_array and not variable.key_types
