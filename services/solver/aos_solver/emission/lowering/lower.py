"""The lowering of a project's typed documents to the model that is emitted.

A pure function of the project. Mistakes of the documents come back as diagnostics, all at once.
"""

import hashlib
from collections.abc import Iterator, Mapping

import msgspec
from msgspec.structs import replace

from aos_language.cpp.keywords import STATES
from aos_language.cpp.pointers import without_null
from aos_language.cpp.snippets import read_cpp_expression
from aos_language.document_code import absent_skills, shared_code_of, snippets_of
from aos_language.findings import Findings
from aos_language.local_types import LocalType, local_type, reported_variables
from aos_language.mission_parameters import parameter_leaves
from aos_language.observed import reported_numbers
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import (
    AbstractionMapping,
    Assignment,
    Environment,
    Iteration,
    Project,
    Skill,
    Snippet,
)
from aos_protocol.documents import Constraint as DocumentedConstraint
from aos_solver.emission.lowering.averages import averaged_draws
from aos_solver.emission.lowering.code import (
    BELIEF,
    DYNAMIC,
    EXTRINSIC,
    GIVEN,
    LOOKING,
    Pieces,
    SectionLowering,
)
from aos_solver.emission.lowering.copies import copies_of
from aos_solver.emission.lowering.cpp_library import headers_for
from aos_solver.emission.lowering.names import check_names
from aos_solver.emission.lowering.relevance import (
    certain_rewards,
    irrelevant_variables,
    sensing_draws,
    skills_alike,
)
from aos_solver.emission.lowering.state import (
    capacities_of,
    lower_compounds,
    lower_variables,
    member_names,
    object_lists,
    parameter_values,
    values_for,
)
from aos_solver.emission.lowering.types import Types, lower_enum
from aos_solver.emission.lowering.writes import Changes, changes_of, drawing_defaults
from aos_solver.emission.program import (
    Constraint,
    Local,
    Monitor,
    Observed,
    Parameter,
    Piece,
    Program,
    SpecialState,
)
from aos_solver.emission.program import Skill as LoweredSkill

_MAX_FLAGS = 64


def lower(project: Project) -> tuple[Program | None, tuple[Diagnostic, ...]]:
    """The program, and what is to be said about the documents; no program if there are errors."""
    findings = Findings()
    check_names(project, findings)
    if findings.has_errors:
        return None, findings.diagnostics
    program = _Lowering(project, findings).program()
    return None if findings.has_errors else program, findings.diagnostics


def _draws_of_a_kind(
    project: Project, sensing: Mapping[Snippet, frozenset[int]]
) -> dict[Snippet, dict[int, str]]:
    """The words that draws are told apart by: see `Draws` in random.hpp."""
    kinds: dict[Snippet, dict[int, str]] = {}
    for kind, draws in (("sensing", sensing), ("averaged", averaged_draws(project))):
        for snippet, starts in draws.items():
            kinds.setdefault(snippet, {}).update(dict.fromkeys(starts, kind))
    return kinds


class _Lowering:
    """One project on its way; the order of the calls is the order of the pieces' numbers."""

    def __init__(self, project: Project, findings: Findings) -> None:
        self._absent_skills = skills_looked_for(project)
        project = _without_absent(project, self._absent_skills)
        environment = project.environment
        self._project = project
        self._findings = findings
        self._shared = shared_code_of(environment)
        self._changes: Changes = changes_of(project)
        self._types = Types(
            environment.enums, environment.compounds, member_names(project), capacities_of(project), findings
        )
        self._alike = skills_alike(project)
        sensing = sensing_draws(project)
        self._certain_rewards = certain_rewards(project, sensing)
        self._pieces = Pieces(findings, _draws_of_a_kind(project, sensing))
        self._code = SectionLowering(
            self._types,
            self._pieces,
            frozenset(self._changes.object_types),
            environment.enums,
            self._shared,
            findings,
        )

    def program(self) -> Program:
        project, environment, code = self._project, self._project.environment, self._code
        enums = tuple(lower_enum(enum) for enum in environment.enums)
        constants = self._shared_piece(late=False)
        compounds = lower_compounds(environment, self._types, self._pieces, code.outside)
        variables = lower_variables(
            project,
            self._changes,
            self._types,
            self._pieces,
            code.outside,
            irrelevant_variables(project),
            self._findings,
        )
        functions = self._shared_piece(late=True)
        initial_belief = code.section(BELIEF, environment.initial_belief)
        extrinsic_changes = code.section(EXTRINSIC, environment.extrinsic_changes)
        special_states = self._special_states(environment)
        state_heuristic = code.section(LOOKING, environment.state_heuristic)
        print_state = code.section(LOOKING, environment.print_state)
        skills = tuple(self._skill(skill) for skill in project.skills)
        monitors = tuple(self._monitors())
        constraints = tuple(self._constraint(constraint) for constraint in project.constraints)
        special_states, skills = self._with_goal_conditions(special_states, skills)
        names = frozenset(self._pieces.identifiers)
        headers = headers_for(names)
        low_level = project.low_level.constants if project.low_level is not None else ()
        value_types = sorted(self._changes.value_types)
        return Program(
            project=project.name,
            digest=_digest(project),
            horizon=environment.horizon,
            discount=environment.discount,
            is_one_state=environment.is_one_state_model,
            enums=enums,
            compounds=compounds,
            variables=variables,
            low_level_constants=tuple(dict.fromkeys(constant.name for constant in low_level)),
            object_lists=object_lists(environment, self._changes),
            enum_lists=tuple(enum for enum in enums if f"{enum.name}Objects" in names),
            value_lists=tuple(parameter_values(environment.variables, name) for name in value_types),
            draws_defaults=any(True for _ in drawing_defaults(environment)),
            initial_belief=initial_belief,
            extrinsic_changes=extrinsic_changes,
            absent_skills=self._absent_skills,
            state_heuristic=state_heuristic,
            print_state=print_state,
            special_states=special_states,
            skills=skills,
            standard_headers=headers,
            pieces=tuple(self._pieces.made),
            constraints=constraints,
            shared_constants=constants,
            shared_functions=functions,
            shared_names=self._shared.all_names,
            leaves=tuple(parameter_leaves(environment).values()),
            monitors=monitors,
        )

    def _monitors(self) -> Iterator[Monitor]:
        models = {model.name: model for model in self._project.environment.monitors}
        for mapping in self._project.monitors:
            model = models[mapping.monitor]
            section = self._code.of(mapping).section(LOOKING, model.code)
            if section is not None:
                responses = tuple(dict.fromkeys(rule.response for rule in mapping.rules))
                yield Monitor(model.name, model.span.file, responses, section)

    def _shared_piece(self, *, late: bool) -> Piece | None:
        snippet = self._project.environment.shared_code
        if snippet is None:
            return None
        if late:
            self._pieces.check(snippet, self._shared.cpp)
            for misuse in self._shared.misuses:
                span = snippet.at(misuse.extent.start)
                self._findings.error("AOS145", misuse.message, span, misuse.hint)
        return self._pieces.declarations(snippet, self._shared, self._code.outside, late=late)

    def _constraint(self, constraint: DocumentedConstraint) -> Constraint:
        mentioned = {mention.path[0] for mention in read_cpp_expression(constraint.never.code).mentions}
        return Constraint(
            self._pieces.expression(constraint.never, self._code.outside),
            constraint.probability,
            constraint.cost,
            tuple(skill.name for skill in self._project.skills if skill.name in mentioned),
            "state__" in mentioned,
        )

    def _special_states(self, environment: Environment) -> tuple[SpecialState, ...]:
        lowered = []
        flags = 0
        for number, special in enumerate(environment.special_states, 1):
            if special.condition is not None and not read_cpp_expression(special.condition.code).is_empty:
                condition = self._pieces.expression(special.condition, self._code.outside)
                section, says_failure = None, special.is_failure is not None
                is_used_up = special.is_one_time and not (special.is_goal or special.is_failure)
            else:
                condition, section = None, self._code.section(LOOKING, special.code)
                is_used_up = section is not None and section.uses("__stopEvaluatingState")
                says_failure = section is not None and section.uses("__isFailureState")
            if is_used_up and flags == _MAX_FLAGS:
                message = f"more than {_MAX_FLAGS} special states that count once"
                self._findings.error("AOS124", message, special.span, "Join some of them in one reward_code")
            bit = 1 << flags if is_used_up else 0
            flags += is_used_up
            lowered.append(
                SpecialState(
                    number=number,
                    bit=bit,
                    condition=condition,
                    reward=special.reward,
                    is_goal=special.is_goal,
                    is_failure=bool(special.is_failure),
                    says_failure=says_failure,
                    is_one_time=special.is_one_time,
                    section=section,
                )
            )
        return tuple(lowered)

    def _with_goal_conditions(
        self, special_states: tuple[SpecialState, ...], skills: tuple[LoweredSkill, ...]
    ) -> tuple[tuple[SpecialState, ...], tuple[LoweredSkill, ...]]:
        """Adds the code that counts conditions, where a reward or goal has several."""
        code = self._code
        counted = []
        for special, lowered in zip(self._project.environment.special_states, special_states, strict=True):
            if lowered.section is not None:
                section = code.goal_conditions(LOOKING, special.code)
                counted.append(replace(lowered, goal_conditions=section))
            elif special.condition is not None and (lowered.is_goal or lowered.reward > 0):
                counted.append(replace(lowered, goal_condition=code.goal_condition(special.condition)))
            else:
                counted.append(lowered)
        return tuple(counted), tuple(
            replace(
                lowered,
                goal_conditions=code.of(skill.mapping).goal_conditions(DYNAMIC, skill.model.dynamic_model),
            )
            for lowered, skill in zip(skills, self._project.skills, strict=True)
        )

    def _skill(self, skill: Skill) -> LoweredSkill:
        model, mapping, code = skill.model, skill.mapping, self._code.of(skill.mapping)
        environment = self._project.environment
        copies = copies_of(model, environment)
        parameters = tuple(
            Parameter(
                parameter.name,
                self._types.plain(parameter.type, parameter.span),
                None if model.possible_parameters else values_for(parameter.type, environment),
            )
            for parameter in model.parameters
        )
        lowered = LoweredSkill(
            name=model.name,
            document=model.span.file,
            parameters=parameters,
            responses=tuple(dict.fromkeys(rule.response for rule in mapping.rules)),
            has_text_response=bool(mapping.response_variable) or _uses_text_response(model.dynamic_model),
            violation_penalty=model.violation_penalty,
            has_alike_groundings=model.name in self._alike,
            has_certain_rewards=model.name in self._certain_rewards,
            possible_parameters=code.section(LOOKING, model.possible_parameters) if parameters else None,
            precondition=code.section(LOOKING, model.precondition),
            execution_time=code.section(LOOKING, model.execution_time),
            dynamic_model=code.section(DYNAMIC, model.dynamic_model),
            rollout_policy=code.section(LOOKING, model.rollout_policy),
            given_observation=code.section(GIVEN, model.state_given_observation),
            reported=reported_variables(mapping, environment),
            observed=tuple(Observed(number.name, number.is_array) for number in reported_numbers(model)),
            keeps_state=copies.keeps_state,
            keeps_state_=copies.keeps_state_,
        )
        return replace(lowered, locals=_locals(mapping, lowered))


def skills_looked_for(project: Project) -> tuple[str, ...]:
    """The skills that the extrinsic changes look for, and that the project does not have (yet)."""
    read = list(snippets_of(project.environment.extrinsic_changes))
    known = {"NULL", "nullptr", *STATES, *(skill.name for skill in project.skills)}
    known |= {declaration.name for _, cpp in read for declaration in cpp.declarations}
    for assignment in project.environment.extrinsic_changes:
        known |= {loop.item for loop in (*assignment.over_previous, *assignment.over_next)}
        known |= {assignment.temporary.name} if assignment.temporary is not None else set()
    return tuple(sorted({name for _, cpp in read for name in absent_skills(cpp, known)}))


def _without_absent(project: Project, absent: tuple[str, ...]) -> Project:
    """The project without the code that runs for absent skills only, whose parameters nobody knows."""

    def cut(snippet: Snippet | None) -> Snippet | None:
        return snippet and replace(snippet, code=without_null(snippet.code, absent))

    def cut_loops(loops: tuple[Iteration, ...]) -> tuple[Iteration, ...]:
        return tuple(replace(loop, condition=cut(loop.condition), body=cut(loop.body)) for loop in loops)

    changes = tuple(
        replace(
            each,
            over_previous=cut_loops(each.over_previous),
            over_next=cut_loops(each.over_next),
            code=cut(each.code),
        )
        for each in project.environment.extrinsic_changes
    )
    return replace(project, environment=replace(project.environment, extrinsic_changes=changes))


def _locals(mapping: AbstractionMapping, skill: LoweredSkill) -> tuple[Local, ...]:
    """The local variables that a correction needs."""
    needed = set(skill.reported)
    if skill.given_observation is not None:
        needed |= skill.given_observation.names - {parameter.name for parameter in skill.parameters}
    return tuple(
        Local(variable.name, _cpp_type(kind), kind)
        for variable in mapping.local_variables
        if variable.name in needed and (kind := local_type(variable.type)) is not None
    )


def _cpp_type(kind: LocalType) -> str:
    element = "std::string" if kind.element == "string" else kind.element
    return f"aos::LocalArray<{element}>" if kind.is_array else element


def _uses_text_response(assignments: tuple[Assignment, ...]) -> bool:
    return any(
        mention.path[0] == "__moduleResponseStr"
        for _, cpp in snippets_of(assignments)
        for mention in cpp.mentions
    )


def _digest(project: Project) -> str:
    """Returns the digest of all that the model depends on; the code in the abstraction mappings is none of
    it."""
    parts = [
        project.name,
        replace(project.environment, shared_mapping_code=None),
        [constant.name for constant in project.low_level.constants] if project.low_level is not None else [],
        [
            (
                skill.model,
                [rule.response for rule in skill.mapping.rules],
                skill.mapping.response_variable,
                [(variable.name, variable.type) for variable in skill.mapping.local_variables],
            )
            for skill in project.skills
        ],
        *[
            [(mapping.monitor, [rule.response for rule in mapping.rules]) for mapping in project.monitors]
            for _ in project.monitors[:1]
        ],
    ]
    return hashlib.sha256(msgspec.json.encode(parts)).hexdigest()
