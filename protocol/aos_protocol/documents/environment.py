"""The environment document: state and its types, initial belief, extrinsic changes, rewards, monitors."""

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.documents.code import Assignment, Snippet

MAX_HORIZON = 10_000
"""Searches call themselves for each decision that they look ahead."""


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
    low_level_span: Span | None = None


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
    low_level_span: Span | None = None
    is_mission_parameter: bool = False

    @property
    def is_constant(self) -> bool:
        """True for what no code of the documents may write."""
        return self.is_parameter_value or self.is_mission_parameter


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
