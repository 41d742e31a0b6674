"""The model between documents and C++: what `lower` makes and `emit` writes.

Everything is resolved here: which variables belong to a particle and which are constants, the C++ type of
each, the document code of each function with the edits it needs. Nothing is laid out.
"""

from __future__ import annotations

import msgspec

from aos_language.local_types import LocalType
from aos_language.mission_parameters import ParameterLeaf
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Snippet


class Edit(msgspec.Struct, frozen=True):
    """`removed` characters from a line and column of a snippet on, replaced by `inserted` others."""

    line: int
    column: int
    removed: int
    inserted: int


class Piece(msgspec.Struct, frozen=True):
    """A snippet as it stands in the emitted file: `text` has the snippet's lines, with few edits.

    `number`, from 1, is what blame.hpp stores while the piece runs. A piece is an expression, or statements,
    or declarations: these stand in a namespace, and whoever calls them is what runs.
    """

    number: int
    snippet: Snippet
    text: str
    edits: tuple[Edit, ...] = ()
    is_statements: bool = False
    is_declarations: bool = False

    def locate(self, line: int, column: int) -> Span:
        """The document place of a line and column of `text`, both from 1."""
        shift = 0
        for edit in (edit for edit in self.edits if edit.line == line):
            if column < edit.column + shift:
                break
            if column < edit.column + shift + edit.inserted:
                return self.snippet.locate(line, edit.column)
            shift += edit.inserted - edit.removed
        return self.snippet.locate(line, column - shift)


# --- state ---


class Enum(msgspec.Struct, frozen=True):
    """An enum with the smallest integer type that holds its values."""

    name: str
    values: tuple[str, ...]
    storage: str


class _Typed(msgspec.Struct, frozen=True):
    name: str
    type: str

    @property
    def is_over_enum(self) -> bool:
        """True for an array over an enum, whose default may be that of each element."""
        return self.type.startswith("aos::Named<")


class Field(_Typed, frozen=True):
    default: Piece | None = None


class Compound(msgspec.Struct, frozen=True):
    name: str
    fields: tuple[Field, ...]


class Axis(msgspec.Struct, frozen=True):
    """One key of a map variable: the C++ type of the axis and of its key."""

    type: str
    key: str


class Variable(_Typed, frozen=True):
    """A state variable. One that nothing changes is a constant, which no particle holds.

    `is_relevant`: what is earned or observed may depend on it (see `lowering.relevance`).
    `is_fixed`: nothing but its default and the initial belief sets it.
    `is_parameter_value`: actions may take it as a parameter. `is_mission_parameter`: a constant whose value
    the engine gets when it is started. The default is an expression for the value, or statements over
    `state.`.
    """

    is_constant: bool
    is_parameter_value: bool = False
    default_value: Piece | None = None
    default_code: Piece | None = None
    axes: tuple[Axis, ...] = ()
    is_relevant: bool = True
    is_fixed: bool = False
    is_mission_parameter: bool = False


class ObjectList(msgspec.Struct, frozen=True):
    """`state.<type>Objects`: the variables of one compound type."""

    type: str
    members: tuple[str, ...]


class ParameterValues(msgspec.Struct, frozen=True):
    """The variables whose values a parameter of this type may take, by name; or the enum's values."""

    type: str
    variables: tuple[str, ...]
    enum_values: tuple[str, ...] = ()


# --- code ---


class EnumVariable(msgspec.Struct, frozen=True):
    """A temporary variable over an enum of its own, whose name stands for the number before its first."""

    name: str
    enum_name: str
    values: tuple[str, ...]
    kind: str = "enum_variable"


class DeclaredVariable(msgspec.Struct, frozen=True):
    """A temporary variable of a known type."""

    name: str
    type: str
    kind: str = "declared_variable"


class Loop(msgspec.Struct, frozen=True):
    """A loop over the variables of a compound type; `inner` runs after the body, under the condition.

    `copy` is the name of the state that it runs over; the item is a copy of the variable unless the block may
    change that state.
    """

    type: str
    item: str
    copy: str
    is_reference: bool
    condition: Piece | None
    body: Piece | None
    inner: Loop | None
    kind: str = "loop"


Statement = EnumVariable | DeclaredVariable | Loop | Piece


class Section(msgspec.Struct, frozen=True):
    """The code of one document section: one C++ function. `names` is every variable name that it uses."""

    statements: tuple[Statement, ...]
    names: frozenset[str]

    def uses(self, name: str) -> bool:
        return name in self.names


class SpecialState(msgspec.Struct, frozen=True):
    """Form A has a condition, form B a section. `bit` is the flag that uses it up; 0 for those that stay.

    `says_failure`: the documents say here what is a failure, and not the reward's sign. `goal_condition` and
    `goal_conditions` are the same code, which counts its conditions.
    """

    number: int
    bit: int
    condition: Piece | None
    reward: float
    is_goal: bool
    is_failure: bool
    says_failure: bool
    is_one_time: bool
    section: Section | None
    goal_condition: Piece | None = None
    goal_conditions: Section | None = None

    @property
    def is_terminal(self) -> bool:
        """True for form A if the mission ends where the condition holds."""
        return self.is_goal or self.is_failure


# --- skills ---


class Parameter(msgspec.Struct, frozen=True):
    name: str
    type: str
    values: ParameterValues | None


class Local(msgspec.Struct, frozen=True):
    """A local variable of the abstraction mapping, with its C++ type."""

    name: str
    type: str
    kind: LocalType


class Observed(msgspec.Struct, frozen=True):
    """A number, or an array of numbers, that a skill reports beside its response."""

    name: str
    is_array: bool


class Skill(msgspec.Struct, frozen=True):
    """A skill: its responses in the order of the mapping's rules, its parameters, its functions.

    `document` is the file that describes it. `reported` are the local variables whose values a real
    observation gives to the state variables of their names, `locals` those and what `given_observation` uses.
    `observed` are the numbers that it reports.
    `has_alike_groundings`: its parameters shape only what is observed.
    `has_certain_rewards`: its draws shape only what is observed.
    `keeps_state` and `keeps_state_`: a step needs these copies of the state (see `lowering.copies`).
    `goal_conditions` is the dynamic model once more, which counts its conditions.
    """

    name: str
    document: str
    parameters: tuple[Parameter, ...]
    responses: tuple[str, ...]
    has_text_response: bool
    violation_penalty: float
    possible_parameters: Section | None
    precondition: Section | None
    execution_time: Section | None
    dynamic_model: Section | None
    rollout_policy: Section | None
    given_observation: Section | None = None
    locals: tuple[Local, ...] = ()
    reported: tuple[str, ...] = ()
    observed: tuple[Observed, ...] = ()
    has_alike_groundings: bool = False
    has_certain_rewards: bool = False
    keeps_state: bool = True
    keeps_state_: bool = True
    goal_conditions: Section | None = None

    @property
    def is_corrected(self) -> bool:
        """True if its real observations tell about the state beyond the response."""
        return self.given_observation is not None or bool(self.reported)

    @property
    def local_bindings(self) -> tuple[tuple[str, str], ...]:
        """The local variables as `given_observation` sees them; a parameter of the same name hides one."""
        hidden = {parameter.name for parameter in self.parameters}
        return tuple(
            (local.name, f"aos_locals.{local.name}") for local in self.locals if local.name not in hidden
        )


class Monitor(msgspec.Struct, frozen=True):
    """A monitor: its responses in the order of the mapping's rules, and the code that gives one."""

    name: str
    document: str
    responses: tuple[str, ...]
    model: Section


class Constraint(msgspec.Struct, frozen=True):
    """An event of a step, with its bound for a mission; `skills` are those that it names."""

    never: Piece
    probability: float
    cost: float
    skills: tuple[str, ...]
    looks_ahead: bool


class Program(msgspec.Struct, frozen=True):
    """A whole model. `pieces[n - 1]` is the piece of number n; `digest` is that of the documents.

    `shared_constants` is the shared code before the compound types, `shared_functions` that behind the state.
    `leaves` are the parts of mission parameters.
    """

    project: str
    digest: str
    horizon: int
    discount: float
    is_one_state: bool
    enums: tuple[Enum, ...]
    compounds: tuple[Compound, ...]
    variables: tuple[Variable, ...]
    low_level_constants: tuple[str, ...]
    object_lists: tuple[ObjectList, ...]
    enum_lists: tuple[Enum, ...]
    value_lists: tuple[ParameterValues, ...]
    draws_defaults: bool
    initial_belief: Section | None
    extrinsic_changes: Section | None
    absent_skills: tuple[str, ...]
    state_heuristic: Section | None
    print_state: Section | None
    special_states: tuple[SpecialState, ...]
    skills: tuple[Skill, ...]
    standard_headers: tuple[str, ...]
    pieces: tuple[Piece, ...]
    constraints: tuple[Constraint, ...] = ()
    shared_constants: Piece | None = None
    shared_functions: Piece | None = None
    shared_names: frozenset[str] = frozenset()
    leaves: tuple[ParameterLeaf, ...] = ()
    monitors: tuple[Monitor, ...] = ()

    @property
    def particle(self) -> tuple[Variable, ...]:
        """The variables that a particle holds."""
        return tuple(variable for variable in self.variables if not variable.is_constant)

    @property
    def irrelevant(self) -> tuple[Variable, ...]:
        """The variables that a particle holds for people and rollout policies only."""
        return tuple(variable for variable in self.particle if not variable.is_relevant)

    @property
    def mission_parameters(self) -> tuple[Variable, ...]:
        """The constants that the engine gets when it is started."""
        return tuple(variable for variable in self.variables if variable.is_mission_parameter)

    @property
    def constants(self) -> tuple[Variable, ...]:
        """The variables that no particle holds."""
        return tuple(variable for variable in self.variables if variable.is_constant)
