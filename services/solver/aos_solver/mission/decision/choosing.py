"""The choice of a mission's next step: an action, an ending, or to hold, for what can be carried out now."""

from collections.abc import Callable, Mapping

import msgspec
from msgspec.structs import replace

from aos_protocol.messages import ActionValue, BeliefSummary, ChosenBy, SearchMade
from aos_protocol.unavailable import told_together
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine, Restriction
from aos_solver.mission.control.steering import Asked
from aos_solver.mission.decision.choices import Choice, Ended, Held, MadeSearches, Refused
from aos_solver.mission.decision.passed_over import EndlessLoops, PassedOver
from aos_solver.mission.decision.risk import RiskBudget
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import Available
from aos_solver.mission.rules.endings import Ending, ending_after_planning, is_held_back, is_worth_nothing
from aos_solver.mission.rules.endings import remark_of as remark_of_ending
from aos_solver.mission.rules.failures import Failures
from aos_solver.mission.rules.terms import Terms

_TOO_RISKY = "it risks more than the mission's constraints have left"
_CAUTIOUSLY = "it is decided as if nothing had run that was not observed"


class _Without(msgspec.Struct, frozen=True):
    """Skills and actions that a decision does without, each with the reason and as the engine has them."""

    reasons: dict[str, str]
    skills: list[str]
    actions: list[int]

    def restriction(self, barred: list[int], *, cautious: bool) -> Restriction:
        return Restriction(
            barred=barred, without=self.skills, without_actions=self.actions, cautious=cautious
        )


_IDLE_DECISIONS = 5  # in a row: one or two may be bad luck of a search
_GIVES_UP = (Ending.SKILLS_FAILED, Ending.NOTHING_WORTHWHILE)


class Chooser:
    """Decides within a mission's limits, constraints and rules for failures.

    `left_out` tells which skills and grounded actions somebody has left out, each with the reason.
    """

    def __init__(
        self,
        terms: Terms,
        failures: Failures,
        around: Available,
        budget: RiskBudget,
        left_out: Callable[[], Mapping[str, str]] = dict,
    ) -> None:
        self._terms = terms
        self.search = terms.search
        self._limits = terms.limits
        self._failures = failures
        self._around = around
        self._budget = budget
        self._left_out = left_out
        self._passed_over = PassedOver(around, terms.hold_s)
        self._searches = MadeSearches()
        self._idle = 0  # decisions in a row
        self._idle_horizon = 0
        self._endless = EndlessLoops()

    @property
    def remark_of_idling(self) -> str:
        """The remark on decisions that would be made for ever; empty where there are none."""
        if self._idle < _IDLE_DECISIONS:
            return ""
        within = f" within the horizon of {self._idle_horizon} decisions" if self._idle_horizon else ""
        return (
            f"the last {self._idle} decisions changed nothing and told nothing, "
            f"since nothing is known that is worth more{within}"
        )

    def drop(self, choice: Choice) -> None:
        """The choice is not carried out; the next decision's record tells of its searches."""
        self._searches.put_back(choice.searches)

    def forget_searches(self) -> None:
        """Another engine decides from now on, whatever was searched in the one before."""
        self._searches.forget()

    def is_something_available(self, engine: Engine) -> bool:
        """Returns whether any action could be carried out now."""
        away = self._around.unavailable.keys() | self._set_aside().keys() | self._left_out().keys()
        actions = engine.description.actions
        return any(action.skill not in away and action.name not in away for action in actions)

    async def choose(self, model: RunningModel, step: int, belief: BeliefSummary) -> Choice | Ended | Held:
        """Chooses what follows at this belief; the action still can be carried out when it is chosen.

        A mission that would give up without what somebody has left out holds for them.
        """
        choice = await self._choose(model, step, belief)
        left_out = self._left_out()
        if left_out and isinstance(choice, Ended) and choice.ending in _GIVES_UP:
            others = [reason for reason in left_out.values() if reason not in choice.remark]
            why = "; ".join([choice.remark, *others])
            return Held(f"the mission holds: {why}", for_operator=True)
        return choice

    async def asked_for(self, model: RunningModel, step: int, asked: Asked) -> Choice | Refused:
        """The choice of an action that somebody has asked for, without a search."""
        engine, reasons = model.engine, self._left_out()
        if not engine.has_action(asked.action):
            return Refused("the documents that run now have no such action")
        index = engine.index_of(asked.action)
        skill = engine.description.actions[index].skill
        for name in (asked.action, skill):
            if name in reasons:
                return Refused(reasons[name], f"Take it back with `aos mission take-back '{name}'`")
        if skill in self._around.unavailable:
            return Refused(self._around.unavailable[skill])
        risks = await engine.risks(self.search.seed_of(step)) if self._budget else None
        if risks is not None and (refusal := self._budget.refusal(risks, index)):
            return Refused(refusal)
        predicted = (await engine.predict(index)).predicted
        plan = Plan(
            index,
            0,
            self.search.horizon_at(step, engine),
            (),
            predicted,
            0.0,
            why=f"{asked.by} has asked for it",
        )
        chosen_by: ChosenBy = "script" if asked.is_script else "operator"
        without, searches = self._without(engine).reasons, self._searches.told(are_dropped=True)
        return Choice(plan, risks, frozenset(), without, False, chosen_by, searches)

    async def _choose(self, model: RunningModel, step: int, belief: BeliefSummary) -> Choice | Ended | Held:
        engine = model.engine
        actions = engine.description.actions
        risks = await engine.risks(self.search.seed_of(step)) if self._budget else None
        forbidden = self._budget.forbidden(risks) if risks is not None else frozenset[int]()
        if risks is not None and len(forbidden) == len(actions):
            return Ended(Ending.TOO_RISKY, self._budget.remark(risks))
        while True:
            without = self._without(engine)
            possible = [
                number
                for number, action in enumerate(actions)
                if action.skill not in without.reasons and action.name not in without.reasons
            ]
            if not set(possible) - forbidden:
                if await self._passed_over.are_searched_anew():
                    continue
                return Ended(Ending.SKILLS_FAILED, _nothing_left(without.reasons))
            unavailable = self._around.unavailable
            barred = {
                n: unavailable.get(actions[n].skill, _TOO_RISKY)
                for n in possible
                if actions[n].skill in unavailable or n in forbidden
            }
            if len(barred) == len(possible):
                why = told_together(sorted({*unavailable.values(), *without.reasons.values()}))
                risky = ", and all others are too risky" if forbidden else ""
                return Held(f"the mission holds, for no skill can be run: {why}{risky}")
            again = await self._repeated(model, set(possible) - barred.keys())
            if again is not None:
                searches = self._searches.told(are_dropped=True)
                return Choice(again, risks, forbidden, without.reasons, False, "retry", searches)
            plan, is_cautious = await self._plan(engine, step, belief, barred, without)
            if actions[plan.index].skill in self._around.unavailable:
                continue
            is_free = not barred and not without.reasons
            self._idle = self._idle + 1 if plan.is_idle and is_free else 0
            self._idle_horizon = max(self._idle_horizon, plan.horizon)
            ended = await self._ending(engine, plan, belief, without)
            gives_up = ended is not None and ended.ending in _GIVES_UP
            if gives_up and await self._passed_over.are_searched_anew():
                continue
            kept_back = _kept_back(plan, {actions[number].name: why for number, why in barred.items()})
            away = {actions[n].skill for n in barred if actions[n].name in kept_back} & unavailable.keys()
            if ended is None and await self._passed_over.are_waited_for(away):
                continue
            told = await self._endless.newly_found(engine)
            told += [f"{name} cannot be chosen now: {why}" for name, why in kept_back.items()]
            plan = _explained(plan, without.reasons, is_cautious, told)
            if ended is not None:
                return ended
            self._passed_over.count(away, {actions[n].skill for n in barred})
            chosen_by, searches = self.search.chosen_by, self._searches.told()
            return Choice(plan, risks, forbidden, without.reasons, is_cautious, chosen_by, searches)

    def _set_aside(self) -> dict[str, str]:
        return self._failures.set_aside(self._around.clock.monotonic_s(), self._around.announced)

    def _without(self, engine: Engine) -> _Without:
        """The skills and actions of the model that are set aside or left out."""
        wanted = {**self._passed_over.reasons(), **self._set_aside(), **self._left_out()}
        actions = engine.description.actions
        skills = {action.skill for action in actions}
        numbers = [number for number, action in enumerate(actions) if action.name in wanted]
        known = skills.union(actions[number].name for number in numbers)
        reasons = {name: why for name, why in wanted.items() if name in known}
        return _Without(reasons, sorted(skills & reasons.keys()), numbers)

    async def _plan(
        self, engine: Engine, step: int, belief: BeliefSummary, barred: Mapping[int, str], without: _Without
    ) -> tuple[Plan, bool]:
        """The best action, and whether it is for the cautious belief.

        It is where the mission would be over but for that belief, or else nothing would be worth doing.
        """
        if not self._terms.is_cautious:
            return await self._search(engine, step, barred, without), False
        if is_held_back(belief, self._limits):
            return await self._search(engine, step, barred, without, cautious=True), True
        plan = await self._search(engine, step, barred, without)
        if belief.cautious is not None and is_worth_nothing(plan.best, self._limits):
            cautious = await self._search(engine, step, barred, without, cautious=True)
            if not is_worth_nothing(cautious.best, self._limits):
                return cautious, True
            self._searches.take_last_but_one()
        return plan, False

    async def _search(
        self,
        engine: Engine,
        step: int,
        barred: Mapping[int, str],
        without: _Without,
        *,
        cautious: bool = False,
    ) -> Plan:
        """A plan, of whose search a record is kept; those before it are dropped."""
        plan = await self.search.run(engine, step, without.restriction(list(barred), cautious=cautious))
        made = SearchMade(
            plan.planner,
            plan.by_thread or (plan.simulations,),
            plan.known_simulations,
            {engine.description.actions[number].name: why for number, why in barred.items()},
            tuple(sorted(without.reasons)),
            cautious,
            engine=engine.starts,
        )
        self._searches.add(made, plan.pondered)
        return plan

    async def _ending(
        self, engine: Engine, plan: Plan, belief: BeliefSummary, without: _Without
    ) -> Ended | None:
        """The ending that the best action calls for.

        Without the skills that are set aside, something is worth doing where it is worth more than nothing,
        and where it leads to a goal at least, unless `stop_below_value` calls that too little. So it is
        without those that are left out, where no goal is out of reach with them as well.
        """
        if without.reasons and is_worth_nothing(plan.best, self._limits):
            is_cautious = belief.cautious is not None
            reach = await engine.may_reach_goal(
                without=without.skills, without_actions=without.actions, cautious=is_cautious
            )
            is_reason = reach.is_reachable or bool(self._set_aside())
            if not is_reason:
                is_reason = (await engine.may_reach_goal(cautious=is_cautious)).is_reachable
            if is_reason and not reach.is_reachable:
                return Ended(Ending.SKILLS_FAILED, _nothing_left(without.reasons))
        if self.remark_of_idling and self._limits.stops_for_nothing:
            return Ended(Ending.NOTHING_WORTHWHILE, self.remark_of_idling)
        ending = ending_after_planning(plan.best, plan.actions, self._limits)
        if ending and without.reasons.keys() & self._set_aside().keys():
            return Ended(Ending.SKILLS_FAILED, _nothing_left(without.reasons))
        if ending is None:
            return None
        remark = remark_of_ending(ending, belief, self._limits)
        if plan.horizon < self.search.whole_horizon(engine):
            remark += " in the decisions that the step limit leaves"
        return Ended(ending, ": ".join(filter(None, (remark, "; ".join(without.reasons.values())))))

    async def _repeated(self, model: RunningModel, allowed: set[int]) -> Plan | None:
        """The action that failed, once more: where that is to be, and it is among those `allowed`."""
        decision = self._failures.to_retry
        if decision is None or model.digest != decision.model_digest:
            return None
        index = model.engine.index_of(decision.action)
        if index not in allowed:
            return None
        prediction = await model.engine.predict(index)
        return Plan(
            index,
            0,
            decision.horizon,
            decision.actions,
            prediction.predicted,
            0.0,
            planner=decision.planner,
            why=self._failures.retry_text,
            place=[action.action for action in decision.actions].index(decision.action),
        )


def _nothing_left(reasons: Mapping[str, str]) -> str:
    return f"nothing is left that is worth doing: {'; '.join(reasons.values())}"


def _kept_back(plan: Plan, barred: Mapping[str, str]) -> dict[str, str]:
    """The actions that are worth more than the choice and cannot be carried out now, with the reasons."""
    best = plan.best

    def is_worth_more(value: ActionValue) -> bool:
        # Estimates are kept at that of the choice, and bounds may prove more.
        if value.at_least is not None and best.at_most is not None and value.at_least > best.at_most:
            return True
        return value.is_known(plan.simulations) and value.q > best.q

    return {
        value.action: barred[value.action]
        for value in plan.actions
        if value.action in barred and is_worth_more(value)
    }


def _explained(plan: Plan, reasons: Mapping[str, str], is_cautious: bool, told: list[str]) -> Plan:
    """The plan, which says why it does without skills and actions, and what else was `told`."""
    texts = [plan.why, *reasons.values(), *([_CAUTIOUSLY] if is_cautious else []), *told]
    return replace(plan, why="; ".join(text for text in texts if text))
