"""All documents of one robot and task, and what its mission adds to them."""

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.documents.code import Assignment, Snippet
from aos_protocol.documents.environment import Environment
from aos_protocol.documents.mapping import AbstractionMapping


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


Content = Environment | SkillModel | AbstractionMapping | LowLevelDocument
"""The content of one document."""


class Skill(msgspec.Struct, frozen=True):
    """A skill's two documents; the registry derives the mapping of a skill that has none written."""

    model: SkillModel
    mapping: AbstractionMapping

    @property
    def name(self) -> str:
        return self.model.name


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
