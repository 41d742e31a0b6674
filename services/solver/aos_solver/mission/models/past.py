"""The past of a belief: what a mission did and observed since the belief started, and its replay.

One rule holds for beliefs: a model's belief is its posterior given the past. A step of a mission, a mission
that is taken up and a model that takes a mission over update their beliefs by the same function.
"""

from collections.abc import AsyncIterator, Iterable, Mapping
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_protocol.documents import DEFAULT_RESPONSE
from aos_protocol.errors import ModelError
from aos_protocol.messages import DecisionRecord, Outcome
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.child.engine import Engine
from aos_solver.mission.rules.failures import Failures


class Evidence(msgspec.Struct, frozen=True):
    """A step of a mission as a belief sees it: the grounded action, and what was observed after it.

    Where nobody observed anything `response` is None, and the skill ran with `ran_probability`. `monitors`
    are what monitors said at the end of the step.
    """

    action: str
    skill: str
    response: str | None = None
    local_variables: Mapping[str, str] = {}
    numbers: Mapping[str, Any] = {}
    ran_probability: float = 1.0
    monitors: Mapping[str, str] = {}


def evidence_of(decision: DecisionRecord, outcome: Outcome, failures: Failures) -> Evidence:
    """The step as a belief sees it."""
    evidence = Evidence(decision.action, decision.skill, monitors=outcome.monitors)
    if outcome.status == "observed":
        return replace(
            evidence,
            response=outcome.response,
            local_variables=outcome.local_variables,
            numbers=outcome.numbers,
        )
    return replace(evidence, ran_probability=failures.ran_probability(outcome))


class Beginning(msgspec.Struct, frozen=True):
    """The start of another mission from what was believed, after `idle` steps of extrinsic changes alone.

    `given` is what somebody knew then: a model of other variables cannot be asked whether it holds.
    """

    idle: int = 0
    given: tuple[str, ...] = ()

    @property
    def action(self) -> str:
        """The words for it, where people read of actions."""
        return "the start of a mission"

    @property
    def response(self) -> str:
        return " and ".join(self.given)


class Past:
    """The steps since a belief started, in order: those of the mission, which adds to it, and before them
    those of the missions whose beliefs it has kept."""

    def __init__(self, refuted_below: float = 0.01, steps: Iterable[Evidence | Beginning] = ()) -> None:
        """`refuted_below` is that of the mission's limits."""
        self.refuted_below = refuted_below
        self.steps: list[Evidence | Beginning] = list(steps)

    def __len__(self) -> int:
        return len(self.steps)


async def replayed(engine: Engine, past: Past, first: int = 0) -> AsyncIterator[BeliefUpdate]:
    """Updates the engine's belief by each step from `first` on, also by those that come meanwhile."""
    number = first
    while number < len(past):
        number += 1
        yield await updated(engine, past.steps[number - 1], past.refuted_below, number=number)


async def updated(
    engine: Engine, evidence: Evidence | Beginning, refuted_below: float, *, number: int | None = None
) -> BeliefUpdate:
    """The belief after a step, and after what monitors said at its end, one after the other.

    A model that lacks the action or the response lets extrinsic changes alone act (`is_foreign`). Where it
    lacks a monitor or its response, that says nothing. `number` is the step's in the past, from 1; it decides
    what is drawn. Without it the engine counts.
    ModelError AOS112 for what somebody knew at the start of a mission.
    """
    if isinstance(evidence, Beginning):
        if evidence.given:
            raise ModelError(f"nobody has asked it whether {evidence.response} held", code="AOS112")
        return BeliefUpdate(0.0, False, await engine.begin_mission(evidence.idle, step=number))
    update = await _stepped(engine, evidence, refuted_below, number)
    for monitor, response in sorted(evidence.monitors.items()):
        if engine.has_monitored(monitor, response):
            seen = await engine.update_by_monitor(monitor, response, refuted_below)
            remark = f"the model excludes that {monitor} says {response}" if seen.is_impossible else ""
            excludes = update.excludes_monitor or seen.is_impossible
            update = replace(update, summary=seen.summary, excludes_monitor=excludes)
        else:
            remark = f"the model has no monitor {monitor} that says {response}"
        if remark:
            text = f"{update.remark}; {remark}" if update.remark else remark
            update = replace(update, remark=text)
    return update


async def _stepped(
    engine: Engine, evidence: Evidence, refuted_below: float, number: int | None
) -> BeliefUpdate:
    """The belief after a step; without an observation by how probable it is that the skill ran."""
    if evidence.response is None and evidence.ran_probability == 0:
        return BeliefUpdate(0.0, False, await engine.summary())
    if _is_foreign(engine, evidence):
        return replace(await engine.pass_time(step=number), is_foreign=True)
    if evidence.response is None:
        return await engine.update_without_observation(
            evidence.action, ran_probability=evidence.ran_probability, step=number
        )
    # An observation that does not come from a mapping has no local variables.
    return await engine.update(
        evidence.action,
        evidence.response,
        evidence.local_variables or None,
        evidence.numbers,
        refuted_below=refuted_below,
        step=number,
    )


def _is_foreign(engine: Engine, evidence: Evidence) -> bool:
    if not engine.has_action(evidence.action):
        return True
    if evidence.response is None or evidence.skill in engine.texting_skills:
        return False
    known = engine.description.responses[evidence.skill]
    return evidence.response not in known and evidence.response != DEFAULT_RESPONSE
