"""What an engine child answers, as typed data."""

from __future__ import annotations

import math
from typing import Any

import msgspec

from aos_protocol.messages import ActionValue, BeliefSummary, PredictedObservation

__all__ = [
    "BeliefUpdate",
    "EngineDescription",
    "ExactValues",
    "ExportedBelief",
    "GroundedAction",
    "Plan",
    "Reach",
    "ReachedAction",
    "SampleCount",
    "WorldStart",
    "WorldStep",
]


class GroundedAction(msgspec.Struct, frozen=True):
    """A skill with values for its parameters: `name` is `skill(parameter=value)`, the values plain data."""

    name: str
    skill: str
    parameters: dict[str, Any]


class EngineDescription(msgspec.Struct, frozen=True):
    """The model as the engine knows it; responses are listed for each skill."""

    project: str
    horizon: int
    discount: float
    actions: tuple[GroundedAction, ...]
    responses: dict[str, tuple[str, ...]]


class Plan(msgspec.Struct, frozen=True):
    """A decision: the index of the best action, and what the search found about each, in their order."""

    index: int
    simulations: int
    horizon: int
    actions: tuple[ActionValue, ...]
    predicted: tuple[PredictedObservation, ...]
    seconds: float

    @property
    def best(self) -> ActionValue:
        return self.actions[self.index]


class BeliefUpdate(msgspec.Struct, frozen=True):
    """The belief after an outcome; `probability` is P(observation | belief, action) before it."""

    probability: float
    is_impossible: bool
    summary: BeliefSummary

    @property
    def surprise(self) -> float:
        """-log P(observation | belief, action) in nats; 0 for an impossible one, which is marked as such."""
        return 0.0 if self.is_impossible else max(0.0, -math.log(self.probability))


class ExactValue(msgspec.Struct, frozen=True):
    action: str
    q: float


class ExactValues(msgspec.Struct, frozen=True):
    """Finite-horizon values of all actions, and how many beliefs and states it took."""

    actions: tuple[ExactValue, ...]
    beliefs: int
    states: int


class ReachedAction(msgspec.Struct, frozen=True):
    """Whether some state that can be reached meets the action's precondition."""

    name: str
    skill: str
    is_met: bool


class Reach(msgspec.Struct, frozen=True):
    """What the actions can lead to; `limit` says why there may be more, and is empty where there is not.

    The search ends early when nothing is missing. `depth` is in actions from the start.
    """

    has_goal: bool
    actions: tuple[ReachedAction, ...]
    states: int
    depth: int
    limit: str


class ExportedBelief(msgspec.Struct, frozen=True):
    """A belief that another engine with the same state layout can take: weights, and states as bytes."""

    is_exact: bool
    particles: tuple[tuple[float, str], ...]


class WorldStart(msgspec.Struct, frozen=True):
    """The hidden state of a new simulated world; `ending` is empty, `goal` or `failure`."""

    ending: str


class WorldStep(msgspec.Struct, frozen=True):
    """One step of the simulated world."""

    reward: float
    response: str
    ending: str


class SampleCount(msgspec.Struct, frozen=True):
    """How many samples of (next state, observation, reward) were drawn, in which time."""

    samples: int
    seconds: float
    mean_reward: float
