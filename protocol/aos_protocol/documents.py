"""The documents as typed data: one model for every dialect.

Written by the registry's readers, sent over the bus, read by the solver's lowering and the middleware's
emission. Nothing here is interpreted: code stays text, in `Snippet`, with the place every line came from.
Names follow the field (skill, response, local variable); the documents' own spellings stay in the readers.

Source: the paper, sections 3.2.1 and 3.2.2; the AOS documentation manual, versions 1.2 and 2.0.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.older_python import StrEnum

__all__ = [
    "ACTIVATION_KINDS",
    "AbstractionMapping",
    "Activation",
    "ActivationField",
    "Assignment",
    "CompoundType",
    "Constraint",
    "EnumType",
    "Environment",
    "Field",
    "Import",
    "Iteration",
    "LocalSource",
    "LocalVariable",
    "LowLevelAssignment",
    "LowLevelConstant",
    "LowLevelDocument",
    "LowLevelType",
    "MissionValue",
    "Parameter",
    "Project",
    "ResponseRule",
    "Skill",
    "SkillModel",
    "Snippet",
    "SpecialState",
    "StateVariable",
    "TemporaryVariable",
]


class Snippet(msgspec.Struct, frozen=True):
    """Code from a document, verbatim.

    `origins[i]` is the place in the document where line `i` of `code` starts, so that a compiler's or an
    interpreter's complaint comes back to the document whatever the dialect did to the text. `escapes` holds
    (line, column, width) of each character of `code` that takes `width` > 1 characters of its document.
    """

    code: str
    origins: tuple[Span, ...]
    escapes: tuple[tuple[int, int, int], ...] = ()

    @property
    def span(self) -> Span:
        """The place where the snippet starts."""
        return self.origins[0]

    def locate(self, line: int, column: int = 1) -> Span:
        """The document place of a line and column of `code`, both from 1; clamped to the snippet."""
        line = min(max(line, 1), len(self.origins))
        column = max(column, 1)
        origin = self.origins[line - 1]
        extra = sum(width - 1 for at, before, width in self.escapes if at == line and before < column)
        return Span(origin.file, origin.line, origin.column + column - 1 + extra)


# --- state ---------------------------------------------------------------------------------------------


class EnumType(msgspec.Struct, frozen=True):
    """An enumerated type; its values are numbered from 0 and share one namespace with all other enums."""

    name: str
    values: tuple[str, ...]
    span: Span
    value_spans: tuple[Span, ...] = ()


class Field(msgspec.Struct, frozen=True):
    """A field of a compound type. `default` is an expression; `low_level_type` belongs to `anyValue`.

    The type of an array is `T[]`, or `T[E]` with an element for each value of the enum E.
    """

    name: str
    type: str
    span: Span
    default: Snippet | None = None
    low_level_type: str | None = None
    type_span: Span | None = None


class CompoundType(msgspec.Struct, frozen=True):
    """A structure of primitive, enum or compound fields."""

    name: str
    fields: tuple[Field, ...]
    span: Span


class StateVariable(msgspec.Struct, frozen=True):
    """A state variable, a value that skills may take as a parameter (`is_parameter_value`), or a constant of
    the mission, whose value whoever starts the mission may set (`is_mission_parameter`).

    `default_value` is an expression, `default_code` statements over `state.`; at most one is given.
    An array with an `index_enum` has an element for each of that enum's values.
    `key_types` makes it a map from tuples of enum names or integer ranges to `type`.
    """

    name: str
    type: str
    span: Span
    is_array: bool = False
    is_parameter_value: bool = False
    default_value: Snippet | None = None
    default_code: Snippet | None = None
    key_types: tuple[str, ...] = ()
    low_level_type: str | None = None
    type_span: Span | None = None
    index_enum: str = ""
    index_span: Span | None = None
    is_mission_parameter: bool = False

    @property
    def is_constant(self) -> bool:
        """True for what no code of the documents may write."""
        return self.is_parameter_value or self.is_mission_parameter


# --- code blocks ---------------------------------------------------------------------------------------


class TemporaryVariable(msgspec.Struct, frozen=True):
    """A variable of a code block. For an enum, `enum_name` and `enum_values` declare its type on the spot."""

    name: str
    type: str
    span: Span
    enum_name: str = ""
    enum_values: tuple[str, ...] = ()


class Iteration(msgspec.Struct, frozen=True):
    """A loop over all state variables of compound type `type`: `body` runs where `condition` holds."""

    type: str
    item: str
    span: Span
    condition: Snippet | None = None
    body: Snippet | None = None


class Assignment(msgspec.Struct, frozen=True):
    """One block of model code. Order of effect: the temporary variable, the loops, then `code`.

    The loops of one tuple are nested; `over_previous` runs over `state`, `over_next` over the copy that the
    block writes.
    """

    span: Span
    name: str = ""
    temporary: TemporaryVariable | None = None
    over_previous: tuple[Iteration, ...] = ()
    over_next: tuple[Iteration, ...] = ()
    code: Snippet | None = None


class SpecialState(msgspec.Struct, frozen=True):
    """A reward or an ending. Form A: `condition`, `reward` and the flags. Form B: `code`, which sets
    `__reward`, `__isGoalState`, `__isFailureState` and `__stopEvaluatingState`.

    Where nothing is said of failure (`is_failure` None, code without the word), the reward's sign says how
    the mission ends.
    """

    span: Span
    condition: Snippet | None = None
    reward: float = 0.0
    is_goal: bool = False
    is_one_time: bool = False
    is_failure: bool | None = None
    code: tuple[Assignment, ...] = ()


class MonitorModel(msgspec.Struct, frozen=True):
    """The model of a monitor: `code` sets its response from `state`, which is the state after a step."""

    name: str
    span: Span
    code: tuple[Assignment, ...] = ()


class Environment(msgspec.Struct, frozen=True):
    """The robot's one environment document: state, initial belief, extrinsic changes, rewards.

    `shared_code` are declarations, constants and functions, that all model code of the project sees;
    `shared_mapping_code` is Python that all mappings see.
    """

    project: str
    span: Span
    horizon: int
    discount: float
    enums: tuple[EnumType, ...] = ()
    compounds: tuple[CompoundType, ...] = ()
    variables: tuple[StateVariable, ...] = ()
    initial_belief: tuple[Assignment, ...] = ()
    special_states: tuple[SpecialState, ...] = ()
    extrinsic_changes: tuple[Assignment, ...] = ()
    state_heuristic: tuple[Assignment, ...] = ()
    print_state: tuple[Assignment, ...] = ()
    is_one_state_model: bool = False
    shared_code: Snippet | None = None
    shared_mapping_code: Snippet | None = None
    monitors: tuple[MonitorModel, ...] = ()


# --- skills --------------------------------------------------------------------------------------------


class Parameter(msgspec.Struct, frozen=True):
    """A skill parameter."""

    name: str
    type: str
    span: Span
    type_span: Span | None = None


class SkillModel(msgspec.Struct, frozen=True):
    """A skill document (SD): how the skill changes the world, what it costs, what it reports."""

    project: str
    name: str
    span: Span
    parameters: tuple[Parameter, ...] = ()
    possible_parameters: tuple[Assignment, ...] = ()
    precondition: tuple[Assignment, ...] = ()
    rollout_policy: tuple[Assignment, ...] = ()
    violation_penalty: float = 0.0
    execution_time: tuple[Assignment, ...] = ()
    dynamic_model: tuple[Assignment, ...] = ()
    state_given_observation: tuple[Assignment, ...] = ()


class Import(msgspec.Struct, frozen=True):
    """`from module import names`, or `import names` where `module` is empty."""

    module: str
    names: tuple[str, ...]
    span: Span


class LowLevelAssignment(msgspec.Struct, frozen=True):
    """Gives the `anyValue` at `path` a new low-level value, a Python expression over local variables.

    `path` is `parameter.field`, or starts with a state variable.
    """

    path: str
    value: Snippet
    span: Span


class ResponseRule(msgspec.Struct, frozen=True):
    """Gives `response` when `condition`, a Python expression over local variables, holds; the first wins.

    With the response come its `assignments`.
    """

    response: str
    condition: Snippet | None
    span: Span
    assignments: tuple[LowLevelAssignment, ...] = ()


class LocalSource(StrEnum):
    """The sources of a local variable's value."""

    PARAMETER = "parameter"
    SERVICE_RESPONSE = "service_response"
    TOPIC = "topic"


class LocalVariable(msgspec.Struct, frozen=True):
    """A value the rules and the activation can use.

    PARAMETER: `parameter_path` is `parameter` or `parameter.field`. SERVICE_RESPONSE: `code` assigns the
    variable from `__input`. TOPIC: `code` is a function body over `__input` that returns the new value;
    `initial_value` is a Python expression, evaluated anew for each activation. `source_span` is where the
    parameter path or the topic stands.
    """

    name: str
    source: LocalSource
    span: Span
    type: str = ""
    parameter_path: str = ""
    topic: str = ""
    message_type: str = ""
    initial_value: Snippet | None = None
    code: Snippet | None = None
    imports: tuple[Import, ...] = ()
    is_heavy: bool = False
    source_span: Span | None = None


class ActivationField(msgspec.Struct, frozen=True):
    """One field of the request: its value is a Python expression over local variables."""

    name: str
    value: Snippet


ACTIVATION_KINDS: Mapping[str, str] = {
    "ros_service": "RosService",
    "ros_action": "RosAction",
    "skill": "Skill",
}
"""The kinds of activation with their words in JSON; `ros_action` and `skill` are ours.

Those of ROS name the type of what they call. Whatever the kind, the path's adapter is called.
"""


class Activation(msgspec.Struct, frozen=True):
    """The way to run the skill: the kind (one of `ACTIVATION_KINDS`), the path, the request's fields."""

    kind: str
    path: str
    span: Span
    service_type: str = ""
    fields: tuple[ActivationField, ...] = ()
    imports: tuple[Import, ...] = ()
    max_duration_s: float | None = None


NO_ACTIVATION = Activation("monitor", "", Span(""))
"""The activation of a monitor's mapping, which calls nothing."""


class AbstractionMapping(msgspec.Struct, frozen=True):
    """An abstraction mapping (AM): from parameters to the call, and from what happened to the observation.

    With `response_variable` the observation is the text of that local variable and the rules do not count.
    `stop_when` is a Python expression over local variables. It is evaluated with each topic message while the
    skill runs, and the first time it is True the skill is cancelled. One that `is_derived` is written
    nowhere: AOS made it from the skill document, where its places are.

    One of a `monitor` belongs to no skill, and calls nothing: its activation is `NO_ACTIVATION`. It is at
    work during the whole mission, its responses are explained by the environment's monitor of this name, and
    its `stop_when` stops whatever runs.
    """

    project: str
    name: str
    span: Span
    activation: Activation
    rules: tuple[ResponseRule, ...] = ()
    response_variable: str = ""
    local_variables: tuple[LocalVariable, ...] = ()
    response_variable_span: Span | None = None
    is_derived: bool = False
    stop_when: Snippet | None = None
    monitor: str = ""


class Skill(msgspec.Struct, frozen=True):
    """A skill's two documents; the registry derives the mapping of a skill that has none written."""

    model: SkillModel
    mapping: AbstractionMapping

    @property
    def name(self) -> str:
        return self.model.name


# --- low-level values ----------------------------------------------------------------------------------


class LowLevelType(msgspec.Struct, frozen=True):
    """A Python-side structure for `anyValue` parameters."""

    name: str
    fields: tuple[Parameter, ...]
    span: Span


class LowLevelConstant(msgspec.Struct, frozen=True):
    """A Python-side value that an `anyValue` field may hold; in model code the name stands for `true`."""

    name: str
    type: str
    code: Snippet
    span: Span


class LowLevelDocument(msgspec.Struct, frozen=True):
    """The environment's Python side (AOS 1.x `EnvironmentGlue`)."""

    project: str
    span: Span
    types: tuple[LowLevelType, ...] = ()
    constants: tuple[LowLevelConstant, ...] = ()


# --- missions ------------------------------------------------------------------------------------------


class Constraint(msgspec.Struct, frozen=True):
    """Whatever a mission does, the event `never` comes to pass in it with at most this `probability`.

    `never` is an expression over `state`, before a step, `state__`, after it, and the action: a skill's name
    stands for a pointer to the action's parameters, null where the action is of another skill. A step where
    it holds violates the constraint, and earns `cost` less in the model.
    """

    never: Snippet
    probability: float
    cost: float = 0.0


class MissionValue(msgspec.Struct, frozen=True):
    """A value for a mission parameter, or for a part of one: `name` is `target`, `place.x` or `wanted[Soda]`.

    `text` is the value as the documents write it, an enum's by its name. `span` is where somebody set it.
    """

    name: str
    text: str
    span: Span


class Project(msgspec.Struct, frozen=True):
    """Everything about one robot and task: what the registry publishes and the generators read.

    `constraints` and `mission_values` are the mission's and not the documents': the solver adds them. No
    generated code depends on the values.

    Skills are sorted by name, so that grounded actions have the same numbers whatever the file names are. So
    are `monitors`, the mappings without a skill, by the name of the monitor.
    """

    name: str
    environment: Environment
    skills: tuple[Skill, ...]
    low_level: LowLevelDocument | None = None
    constraints: tuple[Constraint, ...] = ()
    mission_values: tuple[MissionValue, ...] = ()
    monitors: tuple[AbstractionMapping, ...] = ()

    def skill(self, name: str) -> Skill:
        """The skill of that name; KeyError if there is none."""
        for skill in self.skills:
            if skill.name == name:
                return skill
        raise KeyError(name)
