"""The mission loop: belief, decision, activation, observation, belief.

Knows the engine, and everything else as ports: where records go, how an activation is run, what time it
is, which model comes next. Every decision is in the journal before it is on the bus, and the intention to
move before anything moves.
"""

from __future__ import annotations

from collections.abc import Callable
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
from aos_solver.child.answers import BeliefUpdate
from aos_solver.child.search import Search
from aos_solver.mission.choosing import Available, Choice, Chooser, Ended, Held
from aos_solver.mission.endings import Ending, MissionLimits, ending_of_belief, remark_of
from aos_solver.mission.failures import Failures
from aos_solver.mission.hot_plug import RunningModel
from aos_solver.mission.risk import RiskBudget

__all__ = ["Mission", "Ports"]


class Ports(Available, Protocol):
    """The ports of the loop to the outside."""

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
        self.state = MissionState(name, "waiting", 0, 0.0, revision=model.revision, epoch=epoch)
        self.records: list[DecisionRecord] = []
        self._epoch = epoch
        self._model = model
        self._limits = limits
        self._search = search
        self._ports = ports
        self._activation_timeout_s = activation_timeout_s
        self._failures = failures or Failures()
        self._hold_s = hold_s
        self._is_resumed = False
        self._budget = RiskBudget(model.engine.bounds)
        self._chooser = Chooser(search, limits, self._failures, ports, self._budget)

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
        while (ending := ending_of_belief(belief, steps_taken, self._limits)) is None:
            self._model = await self._ports.newest_model(self._model)
            choice = await self._choose(steps_taken, belief)
            if isinstance(choice, Ended):
                return self._end(choice.ending, choice.remark)
            steps_taken += 1
            decision = self._decide(steps_taken, choice, belief)
            self._move_to("acting", steps_taken, belief, remark=decision.action)
            await self._search.ponder(self._model.engine, steps_taken, choice.plan.index)
            outcome = await self._act(decision)
            belief = await self._observe(decision, outcome)
            if self._failures.to_end:
                return self._end(Ending.SKILLS_FAILED, self._failures.to_end)
            if self._failures.to_hold:
                await self._hold(self._failures.to_hold, steps_taken, belief, lambda: False)
        self._end(ending, remark_of(ending, belief, self._limits))

    async def _choose(self, steps_taken: int, belief: BeliefSummary) -> Choice | Ended:
        """The next decision, or an ending; holds while nothing can be run."""
        engine = self._model.engine
        while True:
            self._move_to("planning", steps_taken, belief)
            choice = await self._chooser.choose(self._model, steps_taken + 1, belief)
            if not isinstance(choice, Held):
                return choice
            await self._hold(
                choice.remark, steps_taken, belief, lambda: self._chooser.is_something_available(engine)
            )

    async def _hold(self, why: str, step: int, belief: BeliefSummary, goes_on: Callable[[], bool]) -> None:
        """Decides nothing until the mission goes on by itself or is resumed, for `hold_s` at most."""
        ends_at_s = self._ports.clock.monotonic_s() + self._hold_s
        self._is_resumed = False
        self._move_to("holding", step, belief, remark=why)
        while not (self._is_resumed or goes_on()):
            now_s = self._ports.clock.monotonic_s()
            left_s = ends_at_s - now_s
            if left_s <= 0:
                raise AosError(f"{why}; nothing has changed for {self._hold_s:g} s", code="AOS513")
            await self._ports.until_changed(min(left_s, self._failures.s_until_return(now_s)))

    def _decide(self, step: int, choice: Choice, belief: BeliefSummary) -> DecisionRecord:
        plan, risks = choice.plan, choice.risks
        actions = self._model.engine.description.actions
        chosen = actions[plan.index]
        told = [number for number, each in enumerate(actions) if each.skill not in choice.set_aside]
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
            preparation_s=plan.preparation_s,
            actions=plan.actions,
            predicted=plan.predicted,
            belief=belief,
            planner=plan.planner,
            why=plan.why,
            threads=plan.threads,
            constraints=self._budget.spend(risks, plan.index, told) if risks is not None else (),
            set_aside=choice.set_aside,
            is_cautious=choice.is_cautious,
        )
        self._publish(record)
        return record

    async def _act(self, decision: DecisionRecord) -> Outcome:
        request = Activate(
            ActivationId(decision.mission, decision.step),
            decision.skill,
            decision.parameters,
            self._failures.rule(decision.skill).timeout_s or self._activation_timeout_s,
            decision.revision,
            self._model.engine.variables_of(decision.action),
            self._epoch,
        )
        self._ports.journal("intended", request)
        outcome = await self._ports.activate(request)
        self._ports.journal("outcome", outcome)
        return outcome

    async def _observe(self, decision: DecisionRecord, outcome: Outcome) -> BeliefSummary:
        before_s = self._ports.clock.monotonic_s()
        update = await self._updated_belief(decision, outcome)
        update_s = self._ports.clock.monotonic_s() - before_s
        remark = self._failures.take(
            decision,
            outcome,
            is_excluded=update.is_excluded,
            surprise=update.surprise,
            now_s=self._ports.clock.monotonic_s(),
            announced=self._ports.announced,
        )
        record = msgspec.structs.replace(
            decision,
            sequence=len(self.records),
            stamp_ns=self._ports.clock.now_ns(),
            belief=update.summary,
            outcome=outcome,
            surprise=update.surprise,
            update_s=update_s,
            is_impossible=update.is_impossible,
            remark="; ".join(each for each in (update.remark, remark) if each),
        )
        self._publish(record)
        return update.summary

    async def _updated_belief(self, decision: DecisionRecord, outcome: Outcome) -> BeliefUpdate:
        """The belief after an outcome; without an observation by how probable it is that the skill ran."""
        engine = self._model.engine
        if outcome.status == "observed":
            # An observation that does not come from a mapping has no local variables.
            return await engine.update(
                decision.action,
                outcome.response,
                outcome.local_variables or None,
                outcome.numbers,
                refuted_below=self._limits.refuted_below,
            )
        ran_probability = self._failures.ran_probability(outcome)
        if ran_probability == 0:
            return BeliefUpdate(0.0, False, await engine.summary())
        return await engine.update_without_observation(decision.action, ran_probability=ran_probability)

    def _publish(self, record: DecisionRecord) -> None:
        self._ports.journal("decision", record)
        self.records.append(record)
        self._ports.publish_record(record)

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
