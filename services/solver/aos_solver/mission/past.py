"""The past of a belief: what a mission did and observed since the belief started, and its replay.

One rule holds for beliefs: a model's belief is its posterior given the past. A step of a mission, a mission
that is taken up and a model that takes a mission over update their beliefs by the same function.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping
from typing import Any

import msgspec

from aos_solver.child.answers import BeliefUpdate
from aos_solver.child.engine import Engine

__all__ = ["Evidence", "Past", "replayed", "updated"]

_DEFAULT_RESPONSE = "DefaultObservation"


class Evidence(msgspec.Struct, frozen=True):
    """A step as a belief sees it: the grounded action, and what was observed after it.

    Where nobody observed anything `response` is None, and the skill ran with `ran_probability`.
    """

    action: str
    skill: str
    response: str | None = None
    local_variables: Mapping[str, str] = {}
    numbers: Mapping[str, Any] = {}
    ran_probability: float = 1.0


class Past:
    """The steps since a belief started, in order. A mission adds to it."""

    def __init__(self, refuted_below: float = 0.01) -> None:
        """`refuted_below` is that of the mission's limits."""
        self.refuted_below = refuted_below
        self.steps: list[Evidence] = []

    def __len__(self) -> int:
        return len(self.steps)


async def replayed(engine: Engine, past: Past, first: int = 0) -> AsyncIterator[BeliefUpdate]:
    """Updates the engine's belief by each step from `first` on, also by those that come meanwhile."""
    number = first
    while number < len(past):
        yield await updated(engine, past.steps[number], past.refuted_below)
        number += 1


async def updated(engine: Engine, evidence: Evidence, refuted_below: float) -> BeliefUpdate:
    """The belief after a step; without an observation by how probable it is that the skill ran.

    A model that lacks the action or the response lets extrinsic changes alone act (`is_foreign`).
    """
    if evidence.response is None and evidence.ran_probability == 0:
        return BeliefUpdate(0.0, False, await engine.summary())
    if _is_foreign(engine, evidence):
        return msgspec.structs.replace(await engine.pass_time(), is_foreign=True)
    if evidence.response is None:
        return await engine.update_without_observation(
            evidence.action, ran_probability=evidence.ran_probability
        )
    # An observation that does not come from a mapping has no local variables.
    return await engine.update(
        evidence.action,
        evidence.response,
        evidence.local_variables or None,
        evidence.numbers,
        refuted_below=refuted_below,
    )


def _is_foreign(engine: Engine, evidence: Evidence) -> bool:
    if not engine.has_action(evidence.action):
        return True
    if evidence.response is None or evidence.skill in engine.texting_skills:
        return False
    known = engine.description.responses[evidence.skill]
    return evidence.response not in known and evidence.response != _DEFAULT_RESPONSE
