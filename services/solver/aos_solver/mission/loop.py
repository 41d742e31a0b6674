"""The mission loop: belief, decision, activation, observation, belief.

Knows the engine, and everything else as ports: where records go, how an activation is run, what time it
is, which model comes next. Every decision is in the journal before it is on the bus, and the intention to
move before anything moves.
"""

from collections.abc import Callable, Sequence

from msgspec.structs import replace

from aos_protocol.errors import AosError, SteeringError
from aos_protocol.messages import (
    Activate,
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    DriftTests,
    MissionState,
    ModelAdopted,
    Outcome,
    Steer,
)
from aos_protocol.mission_rows import ADOPTED, DRIFT, INTENDED, OUTCOME
from aos_runtime.clock import moment_s
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.mission.abandoning import Abandoning
from aos_solver.mission.control.helm import Helm
from aos_solver.mission.control.holding import Holding
from aos_solver.mission.control.steering import LIFTS, Asked
from aos_solver.mission.decision.choices import Choice, Ended, Held, Refused
from aos_solver.mission.decision.choosing import Chooser
from aos_solver.mission.decision.risk import RiskBudget
from aos_solver.mission.models.past import Past, evidence_of, updated
from aos_solver.mission.models.takeover import Earlier, RunningModel, retraced
from aos_solver.mission.ports import Ports
from aos_solver.mission.records.belief_rows import keep_belief
from aos_solver.mission.records.memory import MissionMemory, Pending
from aos_solver.mission.records.reports import Reports, overrun
from aos_solver.mission.rules.drift import after_use, drifts
from aos_solver.mission.rules.endings import Ending, ending_of_belief, remark_of
from aos_solver.mission.rules.failures import Failures
from aos_solver.mission.rules.terms import Terms

_NOTHING = MissionMemory()


class Mission:
    """One mission to its ending, from the engine's belief or from where it was left.

    `run` or `run_or_raise` is called once.

    `belief` is the newest one, `past` how it came to be.
    """

    belief: BeliefSummary

    def __init__(
        self,
        terms: Terms,
        model: RunningModel,
        ports: Ports,
        memory: MissionMemory = _NOTHING,
        before: Past | None = None,
        drift: DriftTests | None = None,
        earlier: Sequence[Earlier] = (),
    ) -> None:
        """`memory` is what the mission has behind it, which has not ended. `before` is the past of the belief
        that it begins with, where that is not the initial one. `drift` are the tests of the mission before.
        `earlier` are the models through which the belief comes to that of `model`, where it is taken up so.
        """
        state = MissionState(terms.name, "waiting", 0, 0.0, revision=model.revision, epoch=terms.epoch)
        self._reports = Reports(state, ports, memory)
        self._memory = memory
        self._terms = terms
        self._model = model
        self._earlier = earlier
        self._ports = ports
        self._failures = Failures(terms.failures)
        self._abandoning = Abandoning()
        self._helm = Helm(memory.steering, ports, self._reports.steered)
        self.past = Past(terms.limits.refuted_below, before.steps if before is not None else ())
        self._adopted: ModelAdopted | None = None
        self._carried_drift = drift
        self.drift = memory.drift or model.drift_tests()
        self._budget = RiskBudget(model.engine.bounds)
        self._chooser = Chooser(terms, self._failures, ports, self._budget, lambda: self._helm.left_out)
        self._holding = Holding(terms.hold_s, ports, self._helm, self._failures, self._adopt)

    @property
    def state(self) -> MissionState:
        """The newest state that was told."""
        return self._reports.state

    async def run(self) -> MissionState:
        """Decide and act until the mission ends; machine faults end it as `fault` with their text."""
        try:
            await self.run_or_raise()
        except AosError as error:
            self._reports.end(Ending.FAULT, str(error))
        self._helm.end(self.state)
        return self.state

    def steer(self, steer: Steer) -> None:
        """Takes what somebody wants, journals it and tells of it; it acts at the next decision.

        What was asked for before changes nothing. SteeringError says why something cannot be done. Whoever
        stops the mission cancels what moves.
        """
        if self.state.phase == "ended":
            raise SteeringError(f"the mission {self.state.mission} has ended, {self.state.ending}")
        is_holding = self.state.phase == "holding"
        if not self._helm.take(steer, self._model.engine.description, is_holding=is_holding):
            return
        if steer.verb in LIFTS:
            self._holding.resume()
        if self._to_stop:
            self._abandoning.begin()
        else:
            self._abandoning.soon()
        self._reports.tell(self._dropped_search())

    def _dropped_search(self) -> str | None:
        """Tells people of a search that goes on while somebody steers; None where none does."""
        if self.state.phase != "planning" or self._to_stop:
            return None
        holder = self._helm.now.held_by if self._helm.now.waits else ""
        then = f"{holder} holds the mission" if holder else "it is decided as the mission is steered then"
        return f"the search that goes on is dropped; {then}"

    async def until_decided(self, request: str) -> None:
        """Returns once the actions of a request were decided for; SteeringError where they will not be."""
        await self._helm.until_decided(request)

    @property
    def _to_stop(self) -> str:
        """The reason why somebody wants it to end as `cancelled` before anything else moves."""
        return self._helm.now.to_stop

    @property
    def activation(self) -> ActivationId | None:
        """The activation that may be moving something now."""
        state = self.state
        return ActivationId(state.mission, state.step) if state.phase == "acting" else None

    async def replay(self) -> None:
        """Brings the engine's belief to where the memory's steps end, and does nothing else."""
        self.belief = await self._model.engine.summary()
        await self._take_up()

    async def run_or_raise(self) -> None:
        """Decide and act until the mission ends, as `run`; AosError for a machine fault."""
        self.belief = await self._model.engine.summary()
        self._begin_drift()
        if not await self._take_up():
            return
        if self.state.step == 0:
            await keep_belief(self._ports, self._model, 0, self.belief)
        while (ending := self._ending()) is None:
            if await self._adopt():
                continue
            if self._helm.now.waits and not self._to_stop:
                by = self._helm.now.held_by
                self._move_to("holding", self.state.step, remark=f"{by} holds the mission")
                await self._holding.for_operator()
                continue
            choice = await self._choose()
            if choice is None:
                continue
            if isinstance(choice, Ended):
                return self._reports.end(choice.ending, choice.remark)
            decision = self._decide(choice)
            self._move_to("acting", decision.step, remark=decision.action)
            await self._terms.search.ponder(self._model.engine, decision.step, choice.plan.index)
            if self._is_stopped() or not await self._finish(decision, await self._act(decision)):
                return
        remark = remark_of(ending, self.belief, self._terms.limits)
        idling = self._chooser.remark_of_idling if ending == Ending.STEP_LIMIT else ""
        self._reports.end(ending, f"{remark}; {idling}" if idling else remark)

    async def _take_up(self) -> bool:
        """Brings the mission to where the memory ends, and the step that is not over to its end.

        The belief comes through the earlier models, or is the posterior of the model that runs now, given
        every action and observation. Returns whether the mission goes on.
        """
        memory, self._memory = self._memory, _NOTHING
        known = len(self.past)
        self.past.steps += [evidence_of(step.decision, step.outcome, self._failures) for step in memory.steps]
        steps = iter(memory.steps)
        async for update in retraced(self._earlier, self._model, self.past, known):
            decision, observed, observed_ns = next(steps)
            self._budget.take_up(decision.constraints)
            self._take_failure(decision, observed, update, moment_s(self._ports.clock, observed_ns))
            self.belief = update.summary
            self._reports.stand_at(decision.step)
        if self._earlier:
            self.belief = await self._model.engine.summary()  # It may have taken over after the last step.
        if memory.pending is not None and self._can_finish(memory.pending):
            decision, intention, outcome = memory.pending
            self._budget.take_up(decision.constraints)
            self._move_to("acting", decision.step, remark=decision.action)
            return await self._finish(decision, outcome or await self._act(decision, intention))
        if memory.is_held and self._failures.to_hold:
            await self._hold(self._failures.to_hold)
        return self._goes_on()

    def _begin_drift(self) -> None:
        """Journals with which tests the mission begins: those that go over, where the model is the same."""
        if self._memory.drift is not None and self._memory.drift.model_digest == self._model.digest:
            return
        carried = self._carried_drift
        if carried is not None and carried.model_digest == self._model.digest:
            self.drift = carried
        else:
            self.drift = self._model.drift_tests()
        self._ports.journal(DRIFT, self.drift)

    async def _finish(self, decision: DecisionRecord, outcome: Outcome) -> bool:
        """Takes the outcome of a decision; returns whether the mission goes on."""
        await self._observe(decision, outcome)
        if self._failures.to_hold:
            await self._hold(self._failures.to_hold)
        return self._goes_on()

    def _goes_on(self) -> bool:
        """Ends the mission where its failures call for that."""
        if self._failures.to_end:
            self._reports.end(Ending.SKILLS_FAILED, self._failures.to_end)
            return False
        return not self._is_stopped()

    def _is_stopped(self) -> bool:
        """Ends the mission where somebody wants that."""
        if self._to_stop:
            self._reports.end(Ending.CANCELLED, self._to_stop)
        return bool(self._to_stop)

    def _can_finish(self, pending: Pending) -> bool:
        """Returns whether a decision can be carried out: one that nobody was asked for can be made anew."""
        return pending.intention is not None or self._model.engine.has_action(pending.decision.action)

    async def _adopt(self) -> bool:
        """Lets the newest model take over if it is ready; returns whether one did."""
        takeover = await self._ports.newest_model(self._model, self.past)
        if takeover is None:
            return False
        before, self._model = self._model, takeover.model
        self.belief, self._adopted = takeover.belief, takeover.row
        self._failures.renew(takeover.model.renewed_since(before))
        if takeover.model.engine is not before.engine:
            self._chooser.forget_searches()
        if takeover.model.digest != before.digest:
            self._terms = replace(self._terms, search=self._terms.search.after_takeover())
            self._chooser.search = self._terms.search
        self._ports.journal(ADOPTED, takeover.row)
        if takeover.model.digest != before.digest:
            self.drift = takeover.model.drift_tests()
            self._ports.journal(DRIFT, self.drift)
        return True

    def _ending(self) -> Ending | None:
        """The ending that the belief calls for, or else the one that the world has come to."""
        return ending_of_belief(self.belief, self.state.step, self._terms.limits) or self._ports.world_ending

    async def _choose(self) -> Choice | Ended | None:
        """The next decision, or an ending; None after a hold, and where somebody has steered meanwhile."""
        step, turns, asked = self.state.step, self._helm.turns, self._helm.asked
        if self._to_stop:
            return Ended(Ending.CANCELLED, self._to_stop)
        self._abandoning.renew()
        self._move_to("planning", step)
        choice = await self._abandoning.unless_given_up(self._next(step + 1, asked))
        if self._to_stop:
            return Ended(Ending.CANCELLED, self._to_stop)
        if choice is None or self._helm.turns != turns:
            if isinstance(choice, Choice):
                self._chooser.drop(choice)
            return None
        if isinstance(choice, Refused):
            assert asked is not None
            self._helm.refuse(asked, choice.why, choice.hint)
            return None
        if not isinstance(choice, Held):
            return choice
        await self._hold(choice.remark, self._may_go_on(choice), adopts=True)
        return None

    async def _next(self, step: int, asked: Asked | None) -> Choice | Ended | Held | Refused:
        """The choice of the action that somebody has asked for, or else the mission's own."""
        if asked is not None:
            return await self._chooser.asked_for(self._model, step, asked)
        return await self._chooser.choose(self._model, step, self.belief)

    def _may_go_on(self, held: Held) -> Callable[[], bool]:
        """Returns what tells that the reason of a hold is gone."""
        engine, turns, helm = self._model.engine, self._helm.turns, self._helm
        if held.for_operator:
            return lambda: helm.turns != turns
        return lambda: helm.turns != turns or self._chooser.is_something_available(engine)

    async def _hold(
        self, why: str, goes_on: Callable[[], bool] = lambda: False, *, adopts: bool = False
    ) -> None:
        """Decides nothing until the mission goes on: see `Holding.until`."""
        self._move_to("holding", self.state.step, remark=why)
        await self._holding.until(why, goes_on, adopts=adopts)

    def _decide(self, choice: Choice) -> DecisionRecord:
        """The record of a decision, which spends what the action risks."""
        risks, index = choice.risks, choice.plan.index
        actions = self._model.engine.description.actions
        told = {value.action for value in choice.plan.actions}
        listed = [number for number, action in enumerate(actions) if action.name in told]
        spent = self._budget.spend(risks, index, listed) if risks is not None else ()
        seed = self._terms.search.seed_of(self.state.step + 1)
        adopted, self._adopted = self._adopted, None
        decision = self._reports.decided(choice, self._model, self.belief, seed, spent, adopted)
        self._helm.decided(decision)
        return decision

    async def _act(self, decision: DecisionRecord, intention: Activate | None = None) -> Outcome:
        """The outcome of a decision's activation; what was intended before is asked for as it was."""
        if intention is not None:
            request = replace(intention, epoch=self._terms.epoch)
        else:
            request = self._request(decision)
        self._ports.journal(INTENDED, request)
        outcome = await self._ports.activate(request, decision.action)
        self._ports.journal(OUTCOME, outcome)
        return outcome

    def _request(self, decision: DecisionRecord) -> Activate:
        return Activate(
            ActivationId(decision.mission, decision.step),
            decision.skill,
            decision.parameters,
            self._failures.rule(decision.skill).timeout_s or self._terms.activation_timeout_s,
            decision.revision,
            self._model.engine.variables_of(decision.action),
            self._terms.epoch,
        )

    async def _observe(self, decision: DecisionRecord, outcome: Outcome) -> None:
        before_s = self._ports.clock.monotonic_s()
        evidence = evidence_of(decision, outcome, self._failures)
        update = await updated(
            self._model.engine, evidence, self.past.refuted_below, number=len(self.past) + 1
        )
        self.past.steps.append(evidence)
        update_s = self._ports.clock.monotonic_s() - before_s
        failure = self._take_failure(decision, outcome, update, self._ports.clock.monotonic_s())
        over = overrun(update, update_s, self._terms.search.time_s)
        remark = "; ".join(text for text in (failure, over) if text)
        before = self.drift
        self.drift = after_use(before, decision, replace(decision, outcome=outcome))
        drift = drifts(before, self.drift, decision.skill)
        self._helm.observed(self._reports.observed(decision, outcome, update, update_s, remark, drift))
        self.belief = update.summary
        await keep_belief(self._ports, self._model, decision.step, self.belief)

    def _take_failure(
        self, decision: DecisionRecord, outcome: Outcome, update: BeliefUpdate, now_s: float
    ) -> str:
        # A response that the decision's own documents do not know is nonsense; others may have known it.
        is_unknown = update.is_foreign and outcome.status == "observed"
        said = self._failures.take(
            decision,
            outcome,
            is_excluded=update.is_excluded or (is_unknown and decision.model_digest == self._model.digest),
            surprise=update.surprise,
            now_s=now_s,
            announced=self._ports.announced,
        )
        if decision.chosen_by in ("operator", "script"):
            self._failures.to_retry = None  # Whoever has asked for it decides that.
        return said

    def _move_to(self, phase: str, step: int, *, remark: str = "") -> None:
        self._reports.move_to(phase, step, self._model, self.belief, remark)
