"""The reasons for a decision: its margin, what was expected, which rewards count, where it changes."""

import math
import time

from aos_protocol.errors import AosError, IntractableError, SkillError, StudyError
from aos_protocol.messages import Consequence, DecisionRecord, Flip, ValueTerm, Why
from aos_protocol.unavailable import told_together
from aos_solver.child.answers.models import RewardTerms
from aos_solver.child.engine import Engine
from aos_solver.mission.models.past import updated
from aos_solver.study.flips import flips_of
from aos_solver.study.replaying import ReplayedMission
from aos_solver.study.supposing import put_aside
from aos_solver.study.traced_engines import TracedEngine, TracedEngines
from aos_solver.study.valuing import Margin, Value, Valuing, best_of

_SHOWN_RESPONSES = 3
_TERM = 1e-12


class Reasons:
    """Explains the decision of the step at which a replay is, and leaves the replay there."""

    def __init__(
        self, replay: ReplayedMission, decision: DecisionRecord, traced: TracedEngines, flips_s: float
    ) -> None:
        """Exact values are computed for `flips_s` to find where the choice changes."""
        self._replay = replay
        self._engine = replay.engine
        self._decision = decision
        self._traced = traced
        self._flips_s = flips_s
        self._valuing = Valuing(replay, decision)
        self._remarks: list[str] = []

    async def why(self, instead: str = "") -> Why:
        """The explanation; SkillError AOS501 for an action that the model does not have."""
        begun_s = time.monotonic()
        decision, valuing = self._decision, self._valuing
        planner = await valuing.begin(self._engine, decision)
        values = await self._values()
        if decision.action not in values:
            raise StudyError(f"{decision.action} has no value: the search did without it")
        other = self._other(instead, values)
        action, others = values[decision.action], values[other]
        if not valuing.is_exact and decision.chosen_by != "policy":
            alone = [
                (await valuing.alone(self._engine, name, valuing.share_alone)).within(values[name])
                for name in (decision.action, other)
            ]
            action, others = action.beside(alone[0]), alone[1]
        margin = Margin.of(action, others)
        belief = await self._engine.summary()
        async with put_aside(self._engine):
            flips = await self._flips(other, margin, begun_s)
            expected = await self._consequences()
        terms, rest, other_rest = await self._terms(other, action.q, others.q)
        after = self._replay.mission.outcome(decision.step)
        return Why(
            mission=decision.mission,
            step=decision.step,
            action=decision.action,
            value=action.q,
            stderr=action.stderr,
            other=other,
            other_value=others.q,
            other_stderr=others.stderr,
            margin=margin.value,
            margin_stderr=margin.stderr,
            is_exact=valuing.is_exact,
            is_close=not valuing.is_exact and margin.is_close,
            simulations_to_tell=self._simulations_to_tell(margin),
            horizon=valuing.horizon,
            planner=planner,
            chosen_by=decision.chosen_by,
            belief=belief,
            expected=expected,
            terms=terms,
            rest=rest,
            other_rest=other_rest,
            flips=flips,
            update_s=after.update_s if after else 0.0,
            update_effort=after.update_effort if after else "",
            remark="; ".join(self._remarks),
        )

    async def _values(self) -> dict[str, Value]:
        """The values that decided; exact ones are computed, since the record has those of missions that plan
        anew at each step."""
        if self._valuing.is_exact:
            return dict(await self._valuing.values(self._engine, anywhere=True))
        if self._valuing.begun is not None:
            return dict(self._valuing.begun)
        return {value.action: Value.of(value) for value in self._decision.actions}

    def _other(self, instead: str, values: dict[str, Value]) -> str:
        made = self._decision.deciding_search
        barred = made.barred if made else {}
        reasons = told_together(barred.values())
        if instead:
            if instead not in values:
                names = ", ".join(name for name in values if name != self._decision.action)
                raise SkillError(f"there is no action {instead}", code="AOS501", hint=f"Name one of {names}")
            if instead == self._decision.action:
                raise StudyError(f"{instead} is the action that was chosen", hint="Name another action")
            if instead in barred:
                self._remarks.append(f"{instead} was barred: {barred[instead]}")
            return instead
        left = {name: value for name, value in values.items() if name not in self._valuing.barred}
        if len(left) < 2:
            why = f": {reasons}" if reasons else ""
            raise StudyError(f"no other action was left to choose{why}", hint="Name one with --instead")
        if barred:
            self._remarks.append(f"barred were {', '.join(barred)}: {reasons}")
        return best_of(left, but=self._decision.action)

    def _simulations_to_tell(self, margin: Margin) -> int:
        if self._valuing.is_exact or not margin.is_close or margin.value == 0:
            return 0
        return math.ceil(self._valuing.spent * (2 * margin.stderr / margin.value) ** 2)

    async def _flips(self, other: str, margin: Margin, begun_s: float) -> tuple[Flip, ...]:
        decision, valuing = self._decision, self._valuing
        if decision.chosen_by not in ("planner", "operator", "script"):
            self._remarks.append(f"it was chosen by {decision.chosen_by}, whatever is believed")
            return ()
        until_s = begun_s + (self._flips_s if valuing.is_exact else math.inf)
        belief = await self._engine.summary()
        return await flips_of(self._engine, valuing, belief, (decision.action, other), margin, until_s)

    async def _consequences(self) -> tuple[Consequence, ...]:
        """The likeliest responses, and the one that came, with what would be done after each."""
        record = self._replay.mission.outcome(self._decision.step)
        outcome = record.outcome if record is not None else None
        if outcome is not None and outcome.status != "observed":
            because = f": {outcome.fault.message}" if outcome.fault is not None else ""
            self._remarks.append(f"nothing was observed, its activation ended as {outcome.status}{because}")
        seen = outcome.response if outcome is not None else ""
        predicted = {each.response: each.probability for each in self._decision.predicted}
        shown = sorted(predicted, key=lambda response: -predicted[response])[:_SHOWN_RESPONSES]
        if seen and seen not in shown:
            shown = [*shown[: _SHOWN_RESPONSES - 1], seen]
        return tuple(
            [await self._consequence(each, predicted.get(each, 0.0), is_seen=each == seen) for each in shown]
        )

    async def _consequence(self, response: str, probability: float, *, is_seen: bool) -> Consequence:
        await self._engine.take_back()
        number = len(self._replay.past) + 1
        record = self._replay.mission.outcome(self._decision.step)
        refuted_below = self._replay.past.refuted_below
        if is_seen and record is not None:
            update = await updated(
                self._engine, self._replay.evidence_of(record), refuted_below, number=number
            )
        else:
            update = await self._engine.update(
                self._decision.action, response, refuted_below=refuted_below, step=number
            )
        goal = update.summary.goal_probability
        if update.is_impossible:
            return Consequence(response, 0.0, is_seen, goal)
        over = goal + update.summary.failure_probability + update.summary.over_probability
        if goal >= self._replay.goal_probability or over >= 1 - _TERM:
            return Consequence(response, probability, is_seen, goal)
        values = await self._valuing.values(self._engine, share=self._valuing.share)
        best = best_of(values)
        return Consequence(response, probability, is_seen, goal, best, values[best].q, values[best].stderr)

    async def _terms(
        self, other: str, value: float, other_value: float
    ) -> tuple[tuple[ValueTerm, ...], float, float]:
        """The parts of both values by statement, and what is not told apart of each."""
        try:
            traced = await self._traced.of(await self._replay.model())
            await traced.engine.import_beliefs(await self._engine.export_beliefs())
            one, two = [
                await self._terms_of(traced.engine, action) for action in (self._decision.action, other)
            ]
        except IntractableError as error:
            self._remarks.append(f"the rewards cannot be told apart: {error.message}")
            return (), value, other_value
        except AosError as error:
            self._remarks.append(f"the rewards are not told apart: {error.message}")
            return (), value, other_value
        if one.drawn:
            self._remarks.append(f"rewards of lines are means of {one.drawn:,} steps that were drawn")
        terms = _joined(traced, one, two)
        rests = [v - sum(t.amount for t in found.terms) for v, found in ((value, one), (other_value, two))]
        return terms, rests[0], rests[1]

    async def _terms_of(self, engine: Engine, action: str) -> RewardTerms:
        index = [known.name for known in engine.description.actions].index(action)
        return await engine.reward_terms(
            index,
            horizon=self._valuing.horizon,
            is_first=not self._valuing.is_exact,
            cautious=self._valuing.within.cautious,
        )


def _joined(traced: TracedEngine, one: RewardTerms, two: RewardTerms) -> tuple[ValueTerm, ...]:
    """The terms of two values by their places, those that differ most first."""
    parts: dict[str, list[float]] = {}
    for column, found in enumerate((one, two)):
        for term in found.terms:
            parts.setdefault(traced.place(term), [0.0, 0.0])[column] += term.amount
    terms = [ValueTerm(place, *amounts) for place, amounts in parts.items()]
    return tuple(sorted(terms, key=lambda term: -abs(term.value - term.other)))
