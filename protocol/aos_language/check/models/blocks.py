"""The pieces of model code of the documents, each with what it may read and write."""

from collections.abc import Iterable, Iterator, Mapping

import msgspec

from aos_language.cpp.keywords import STATES
from aos_language.cpp.snippets import Cpp, read_cpp, read_cpp_declarations, read_cpp_expression
from aos_protocol.documents import Assignment, Environment, Iteration, SkillModel, Snippet


class Role(msgspec.Struct, frozen=True):
    """The task of a block: its name in messages, the copies of the state it may read and may write.

    `names` are those of the language that its code has besides, such as `__reward`.
    """

    title: str
    reads: tuple[str, ...]
    writes: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    sees_chosen_action: bool = False
    may_set_parameter_values: bool = False


class Block(msgspec.Struct, frozen=True):
    """One snippet in its role: statements, an expression, or declarations.

    `names` are the typed names around it: `constants`, items, temporaries. `constants` are the skill's
    parameters, which no code may write. `sets` is the variable or field whose default it is, and `type` what
    an expression for it gives.
    """

    role: Role
    snippet: Snippet
    is_expression: bool = False
    is_declarations: bool = False
    names: Mapping[str, str] = {}
    constants: Mapping[str, str] = {}
    sets: str = ""
    type: str = ""


def read_block(block: Block) -> Cpp:
    """A block's snippet, read."""
    if block.is_declarations:
        return read_cpp_declarations(block.snippet.code)
    return (read_cpp_expression if block.is_expression else read_cpp)(block.snippet.code)


DEFAULT = Role("the default of a variable", ("state",), ("state",), may_set_parameter_values=True)
SHARED = Role("shared code", STATES, STATES)
INITIAL = Role("the initial belief", ("state",), ("state",))
SPECIAL = Role(
    "a special state",
    ("state",),
    names=("__isFailureState", "__isGoalState", "__reward", "__stopEvaluatingState"),
)
EXTRINSIC = Role(
    "the extrinsic changes",
    ("state", "state_"),
    ("state_",),
    names=("__moduleExecutionTime", "__reward"),
    sees_chosen_action=True,
)
HEURISTIC = Role("the state heuristic", ("state",), names=("__heuristicValue",))
PRINT = Role("the print function", ("state",))
MONITOR = Role("the model of a monitor", ("state",), names=("__moduleResponse",))
PARAMETERS = Role("the list of parameters", ("state",), names=("__possibleParameters",))
PRECONDITION = Role("the precondition", ("state",), names=("__meetPrecondition",))
ROLLOUT = Role("the rollout policy", ("state",), names=("__heuristicValue",))
DURATION = Role("the execution time", ("state",), names=("__moduleExecutionTime",))
DYNAMIC = Role(
    "the dynamic model",
    ("state", "state_", "state__"),
    ("state__",),
    names=(
        "__meetPrecondition",
        "__moduleExecutionTime",
        "__moduleResponse",
        "__moduleResponseStr",
        "__observed",
        "__reward",
    ),
)
GIVEN_OBSERVATION = Role("the state given the observation", ("state__", "state___"), ("state___",))


_ROLES = (SPECIAL, EXTRINSIC, HEURISTIC, MONITOR, PARAMETERS, PRECONDITION, ROLLOUT, DURATION, DYNAMIC)


def titles_with(name: str) -> list[str]:
    """The kinds of code that have a name of the language, such as `__reward`."""
    return [role.title for role in _ROLES if name in role.names]


def environment_blocks(environment: Environment) -> Iterator[Block]:
    """All code of the environment, in the order of the document model."""
    if environment.shared_code is not None:
        yield Block(SHARED, environment.shared_code, is_declarations=True)
    for compound in environment.compounds:
        for field in compound.fields:
            if field.default is not None:
                yield Block(DEFAULT, field.default, True, sets=field.name, type=field.type)
    for variable in environment.variables:
        if variable.default_value is not None:
            yield Block(DEFAULT, variable.default_value, True, sets=variable.name, type=variable.type)
        if variable.default_code is not None:
            yield Block(DEFAULT, variable.default_code, sets=variable.name)
    yield from assignment_blocks(INITIAL, environment.initial_belief)
    for special in environment.special_states:
        if special.condition is not None:
            yield Block(SPECIAL, special.condition, is_expression=True)
        yield from assignment_blocks(SPECIAL, special.code)
    yield from assignment_blocks(EXTRINSIC, environment.extrinsic_changes)
    yield from assignment_blocks(HEURISTIC, environment.state_heuristic)
    yield from assignment_blocks(PRINT, environment.print_state)
    for monitor in environment.monitors:
        yield from assignment_blocks(MONITOR, monitor.code)


def skill_blocks(model: SkillModel) -> Iterator[Block]:
    """All code of a skill, in the order of the document model."""
    names = {parameter.name: parameter.type for parameter in model.parameters}
    yield from assignment_blocks(PARAMETERS, model.possible_parameters)
    yield from assignment_blocks(PRECONDITION, model.precondition, names)
    yield from assignment_blocks(ROLLOUT, model.rollout_policy, names)
    yield from assignment_blocks(DURATION, model.execution_time, names)
    yield from assignment_blocks(DYNAMIC, model.dynamic_model, names)
    yield from given_observation_blocks(model)


def all_blocks(environment: Environment, models: Iterable[SkillModel]) -> Iterator[Block]:
    """All code of the environment and the skills."""
    yield from environment_blocks(environment)
    for model in models:
        yield from skill_blocks(model)


def given_observation_blocks(model: SkillModel) -> Iterator[Block]:
    """A skill's code for a state given an observation."""
    names = {parameter.name: parameter.type for parameter in model.parameters}
    yield from assignment_blocks(GIVEN_OBSERVATION, model.state_given_observation, names)


def assignment_blocks(
    role: Role, assignments: tuple[Assignment, ...], parameters: Mapping[str, str] | None = None
) -> Iterator[Block]:
    """The snippets of a block's assignments; a temporary is visible in those after it too."""
    constants = dict(parameters or {})
    visible = dict(constants)
    for assignment in assignments:
        if assignment.temporary is not None:
            visible[assignment.temporary.name] = assignment.temporary.enum_name or assignment.temporary.type
        for loops in (assignment.over_previous, assignment.over_next):
            yield from _loop_blocks(role, loops, visible, constants)
        if assignment.code is not None:
            yield Block(role, assignment.code, names=dict(visible), constants=constants)


def _loop_blocks(
    role: Role, loops: tuple[Iteration, ...], names: Mapping[str, str], constants: Mapping[str, str]
) -> Iterator[Block]:
    inner = dict(names)
    for loop in loops:
        inner[loop.item] = loop.type
        if loop.condition is not None:
            yield Block(role, loop.condition, True, names=dict(inner), constants=constants)
        if loop.body is not None:
            yield Block(role, loop.body, names=dict(inner), constants=constants)
