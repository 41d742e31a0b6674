"""The mission loop: belief, decision, activation, observation, belief.

Knows the engine, and everything else as ports: where records go, how an activation is run, what time it
is, which model comes next. Every decision is in the journal before it is on the bus, and the intention to
move before anything moves.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import msgspec

from aos_protocol.errors import AosError
from aos_protocol.messages import (
    Activate,
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    Message,
    MissionState,
    Outcome,
)
from aos_runtime.clock import Clock
from aos_solver.child.answers import BeliefUpdate, Plan, Risks
from aos_solver.endings import Ending, MissionLimits, ending_after_planning, ending_of_belief, remark_of
from aos_solver.failures import Failures
from aos_solver.hot_plug import RunningModel
from aos_solver.risk import RiskBudget
from aos_solver.search import Search

__all__ = ["Mission", "Ports"]

FAILURE_LIMIT = 3
"""Activations in a row without an observation before a mission ends, unless it is told another number."""

RAN_PROBABILITY = 0.5
"""How probable it is that a skill without an observation did its work. The belief is the mixture of both."""


class Ports(Protocol):
    """What the loop needs from outside."""

    clock: Clock

    @property
    def unavailable(self) -> Mapping[str, str]:
        """The skills that nobody could run now, each with the reason."""
        ...

    async def until_changed(self, timeout_s: float) -> None:
        """Returns when other skills are available, when somebody wants the mission to go on, or in time."""
        ...

    def journal(self, kind: str, payload: Message) -> None:
        """Write durably; returns once it is on the disk."""
        ...

    def publish_record(self, record: DecisionRecord) -> None: ...

    def publish_state(self, state: MissionState) -> None: ...

    async def activate(self, request: Activate) -> Outcome:
        """Run a grounded action; AosError when nobody can be asked or nobody answers."""
        ...

    async def newest_model(self, running: RunningModel) -> RunningModel:
        """The model for the next decision, with the running one's belief: the same, or a hot-plugged one."""
        ...


class Mission:
    """One mission from the initial belief to its ending; `run` is called once."""

    def __init__(
        self,
        name: str,
        epoch: int,
        model: RunningModel,
        limits: MissionLimits,
        search: Search,
        ports: Ports,
        *,
        activation_timeout_s: float,
        failures: Failures | None = None,
        hold_s: float = 600.0,
    ) -> None:
        self.state = MissionState(name, "waiting", 0, 0.0, revision=model.revision)
        self.records: list[DecisionRecord] = []
        self._epoch = epoch
        self._model = model
        self._limits = limits
        self._search = search
        self._ports = ports
        self._activation_timeout_s = activation_timeout_s
        self._failures = failures or Failures({}, FAILURE_LIMIT)
        self._hold_s = hold_s
        self._is_resumed = False
        self._budget = RiskBudget(model.engine.bounds)
        self._risks: Risks | None = None

    async def run(self) -> MissionState:
        """Decide and act until the mission ends; machine faults end it as `fault` with their text."""
        try:
            await self._run_until_ended()
        except AosError as error:
            self._end(Ending.FAULT, str(error))
        return self.state

    def cancel(self, reason: str) -> None:
        """Record that the mission was stopped from outside."""
        if not self.state.ending:
            self._end(Ending.CANCELLED, reason)

    def resume(self) -> None:
        """Somebody has looked after what the mission holds for."""
        self._is_resumed = True

    async def _run_until_ended(self) -> None:
        belief = await self._model.engine.summary()
        steps_taken = 0
        while not self._ends_with(ending_of_belief(belief, steps_taken, self._limits), belief):
            self._model = await self._ports.newest_model(self._model)
            self._risks = await self._risks_at(steps_taken + 1)
            plan = await self._plan(steps_taken, belief)
            if plan is None:
                return
            if self._ends_with(ending_after_planning(plan.best, self._limits), belief):
                return
            steps_taken += 1
            decision = self._decide(steps_taken, plan, belief)
            self._move_to("acting", steps_taken, belief, remark=decision.action)
            await self._search.ponder(self._model.engine, steps_taken, plan.index)
            outcome = await self._act(decision)
            belief = await self._observe(decision, outcome)
            self._failures.take(decision, outcome)
            if self._failures.to_end:
                return self._end(Ending.SKILLS_FAILED, self._failures.to_end)
            if self._failures.to_hold:
                await self._hold(self._failures.to_hold, steps_taken, belief, lambda: False)

    async def _plan(self, steps_taken: int, belief: BeliefSummary) -> Plan | None:
        """The next decision: for what can be carried out now, and still can be when it is made.

        None where every action is too risky, which ends the mission.
        """
        while True:
            if self._is_all_too_risky():
                assert self._risks is not None
                self._end(Ending.TOO_RISKY, self._budget.remark(self._risks))
                return None
            barred = self._barred()
            retried = self._failures.to_retry
            if retried is not None and self._model.digest == retried.model_digest:
                index = self._index_of(retried)
                if index not in barred:
                    return await self._repeated(retried, index)
            if barred and not self._is_something_available():
                why = "; ".join(sorted(set(self._ports.unavailable.values())))
                risky = ", and all others are too risky" if self._forbidden() else ""
                text = f"the mission holds, for no skill can be run: {why}{risky}"
                await self._hold(text, steps_taken, belief, self._is_something_available)
                continue
            self._move_to("planning", steps_taken, belief)
            plan = await self._search.run(self._model.engine, steps_taken + 1, barred)
            if plan.index not in self._barred():
                return plan

    def _barred(self) -> list[int]:
        """The numbers of the actions that nobody could carry out now, or that are too risky."""
        unavailable, forbidden = self._ports.unavailable, self._forbidden()
        actions = self._model.engine.description.actions
        return [
            number
            for number, action in enumerate(actions)
            if action.skill in unavailable or number in forbidden
        ]

    async def _risks_at(self, step: int) -> Risks | None:
        """What each action risks now, where there are constraints."""
        return await self._model.engine.risks(self._search.seed_of(step)) if self._budget else None

    def _forbidden(self) -> frozenset[int]:
        return self._budget.forbidden(self._risks) if self._risks is not None else frozenset()

    def _is_all_too_risky(self) -> bool:
        return len(self._forbidden()) == len(self._model.engine.description.actions)

    def _is_something_available(self) -> bool:
        return len(self._barred()) < len(self._model.engine.description.actions)

    def _index_of(self, decision: DecisionRecord) -> int:
        names = [action.name for action in self._model.engine.description.actions]
        return names.index(decision.action)

    async def _repeated(self, decision: DecisionRecord, index: int) -> Plan:
        prediction = await self._model.engine.predict(index)
        return Plan(
            index,
            0,
            decision.horizon,
            decision.actions,
            prediction.predicted,
            0.0,
            planner=decision.planner,
            why=self._failures.retry_text,
        )

    async def _hold(self, why: str, step: int, belief: BeliefSummary, goes_on: Callable[[], bool]) -> None:
        """Decides nothing until the mission goes on by itself or is resumed, for `hold_s` at most."""
        ends_at_s = self._ports.clock.monotonic_s() + self._hold_s
        self._is_resumed = False
        self._move_to("holding", step, belief, remark=why)
        while not (self._is_resumed or goes_on()):
            left_s = ends_at_s - self._ports.clock.monotonic_s()
            if left_s <= 0:
                raise AosError(f"{why}; nothing has changed for {self._hold_s:g} s", code="AOS513")
            await self._ports.until_changed(left_s)

    def _decide(self, step: int, plan: Plan, belief: BeliefSummary) -> DecisionRecord:
        chosen = self._model.engine.description.actions[plan.index]
        record = DecisionRecord(
            sequence=len(self.records),
            stamp_ns=self._ports.clock.now_ns(),
            mission=self.state.mission,
            epoch=self._epoch,
            step=step,
            action=chosen.name,
            skill=chosen.skill,
            parameters=chosen.parameters,
            model_digest=self._model.digest,
            revision=self._model.revision,
            seed=self._search.seed_of(step),
            simulations=plan.simulations,
            horizon=plan.horizon,
            planning_s=plan.seconds,
            actions=plan.actions,
            predicted=plan.predicted,
            belief=belief,
            planner=plan.planner,
            why=plan.why,
            threads=plan.threads,
            constraints=self._budget.spend(self._risks, plan.index) if self._risks is not None else (),
        )
        self._publish(record)
        return record

    async def _act(self, decision: DecisionRecord) -> Outcome:
        request = Activate(
            ActivationId(decision.mission, decision.epoch, decision.step),
            decision.skill,
            decision.parameters,
            self._failures.rule(decision.skill).timeout_s or self._activation_timeout_s,
            decision.revision,
            self._model.engine.variables_of(decision.action),
        )
        self._ports.journal("intended", request)
        outcome = await self._ports.activate(request)
        self._ports.journal("outcome", outcome)
        return outcome

    async def _observe(self, decision: DecisionRecord, outcome: Outcome) -> BeliefSummary:
        update = await self._updated_belief(decision, outcome)
        record = msgspec.structs.replace(
            decision,
            sequence=len(self.records),
            stamp_ns=self._ports.clock.now_ns(),
            belief=update.summary,
            outcome=outcome,
            surprise=update.surprise,
            is_impossible=update.is_impossible,
            remark=update.remark,
        )
        self._publish(record)
        return update.summary

    async def _updated_belief(self, decision: DecisionRecord, outcome: Outcome) -> BeliefUpdate:
        """The belief after an outcome. Without an observation it is the mixture of "it ran" and "it did not";
        after a refusal it is what it was.
        """
        engine = self._model.engine
        if outcome.status == "observed":
            # An observation that does not come from a mapping has no local variables.
            return await engine.update(
                decision.action, outcome.response, outcome.local_variables or None, outcome.numbers
            )
        if outcome.status == "refused":
            return BeliefUpdate(0.0, False, await engine.summary())
        return await engine.update_without_observation(decision.action, ran_probability=RAN_PROBABILITY)

    def _publish(self, record: DecisionRecord) -> None:
        self._ports.journal("decision", record)
        self.records.append(record)
        self._ports.publish_record(record)

    def _ends_with(self, ending: Ending | None, belief: BeliefSummary) -> bool:
        if ending is None:
            return False
        self._end(ending, remark_of(ending, belief, self._limits))
        return True

    def _move_to(self, phase: str, step: int, belief: BeliefSummary, *, remark: str = "") -> None:
        self._change_state(
            phase=phase,
            step=step,
            goal_probability=belief.goal_probability,
            remark=remark,
            revision=self._model.revision,
        )

    def _end(self, ending: Ending, remark: str) -> None:
        goal = self.records[-1].belief.goal_probability if self.records else 0.0
        self._change_state(phase="ended", ending=ending.value, remark=remark, goal_probability=goal)

    def _change_state(self, **changes: Any) -> None:
        self.state = msgspec.structs.replace(self.state, **changes)
        self._ports.journal("mission", self.state)
        self._ports.publish_state(self.state)
