"""The skill document (SD): how a skill changes the world, what it costs, what it reports."""

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.documents.code import Assignment


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
