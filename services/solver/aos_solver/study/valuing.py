"""The values of actions at a belief that a study supposes: exact where the decision was, else searched."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Self

import msgspec
from msgspec.structs import replace

from aos_protocol.messages import ActionValue, DecisionRecord
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine, Restriction
from aos_solver.child.search import Search
from aos_solver.study.replaying import ReplayedMission


class Value(msgspec.Struct, frozen=True):
    """The value of an action and its standard error; `n` is how often a search tried it. What is proven of it
    is `at_least` and `at_most`."""

    q: float
    stderr: float = 0.0
    n: int = 0
    at_least: float = -math.inf
    at_most: float = math.inf

    @classmethod
    def of(cls, told: ActionValue) -> Self:
        least = -math.inf if told.at_least is None else told.at_least
        most = math.inf if told.at_most is None else told.at_most
        return cls(told.q, told.stderr, told.n, least, most)

    def within(self, decided: Value) -> Value:
        """The value as far as what was proven at the decision leaves room for it, and so its error.

        The searches of a mission have found out more than one new search does.
        """
        least = min(decided.at_least, decided.q)
        room = max(decided.at_most - least, decided.stderr)
        return Value(min(max(self.q, least), decided.at_most), min(self.stderr, room), self.n)

    def beside(self, other: Value) -> Value:
        """The value with an error that counts what another, shorter search of it has found.

        Which ways of going on a search finds is luck, and a longer one finds more. Of neither does its own
        standard error know.
        """
        return Value(self.q, math.hypot(max(self.stderr, other.stderr), self.q - other.q), self.n)


class Margin(msgspec.Struct, frozen=True):
    """The difference between the values of two actions, with its standard error."""

    value: float
    stderr: float

    @property
    def is_close(self) -> bool:
        """Says whether the difference is within two standard errors; a tie always is."""
        return abs(self.value) <= 2 * self.stderr

    @classmethod
    def of(cls, one: Value, other: Value) -> Margin:
        return cls(one.q - other.q, math.hypot(one.stderr, other.stderr))


class Valuing:
    """Values what the engine believes as the decision of a step was valued.

    A share of the decision's budget is `share` of its simulations or its time.
    """

    def __init__(self, replay: ReplayedMission, decision: DecisionRecord) -> None:
        self._search = replay.search_by(decision)
        self._step = decision.step
        made = decision.deciding_search
        self.within = replay.restriction_of(made) if made is not None else Restriction()
        self.is_exact = decision.planner == "exact" and not self.within.without
        self.horizon = decision.horizon
        self.share, self.share_alone, self.share_beside = 1 / 8, 1 / 2, 1 / 13
        """The share of the decision's budget for each belief after a response, of three at most, that for
        each of two actions alone, and that for each of both at another probability, of four: so that all
        searches of an explanation take twice the budget."""
        self.spent = sum(made.simulations) + made.known if made is not None else 0
        """The simulations that the values of the decision stand on."""
        self.begun: Mapping[str, Value] | None = None
        """The values at the decision's belief, where nothing was searched for it in the mission."""
        numbers = {action.name: n for n, action in enumerate(replay.engine.description.actions)}
        self.barred = {name for name, number in numbers.items() if number in self.within.barred}

    async def begin(self, engine: Engine, decision: DecisionRecord) -> str:
        """Finds the planner for a decision that nothing was searched for; returns whose values count."""
        if decision.deciding_search is not None:
            return decision.planner
        plan = await self._search.run(engine, self._step, self.within)
        self.is_exact = plan.planner == "exact" and not self.within.without
        self.horizon = plan.horizon
        self.spent = plan.simulations + plan.known_simulations
        self.begun = _values_of(plan)
        self.share, self.share_alone, self.share_beside = 1 / 16, 1 / 4, 1 / 26  # A whole budget is spent.
        return plan.planner

    async def values(
        self, engine: Engine, *, share: float = 1.0, anywhere: bool = False
    ) -> Mapping[str, Value]:
        """The value of each action that may be chosen; `anywhere` also that of barred ones."""
        if self.is_exact:
            found = await engine.exact_values(self.horizon, cautious=self.within.cautious)
            values = {value.action: Value(value.q, n=1) for value in found.actions}
        else:
            within = replace(self.within, barred=(), cautious=False) if anywhere else self.within
            plan = await self._with(share).run(engine, self._step, within)
            values = _values_of(plan)
        return values if anywhere else {name: v for name, v in values.items() if name not in self.barred}

    async def alone(self, engine: Engine, action: str, share: float, *, is_moved: bool = False) -> Value:
        """The value of an action in a search that begins with it alone, with a share of the budget.

        `is_moved`: the engine believes what somebody supposes.

        A search that decides tries what seems worse less often, and so undervalues what comes after it.
        """
        actions = engine.description.actions
        barred = [number for number, each in enumerate(actions) if each.name != action]
        cautious = self.within.cautious and not is_moved
        within = replace(self.within, barred=barred, cautious=cautious)
        plan = await self._with(share).run(engine, self._step, within)
        return _values_of(plan)[action]

    def _with(self, share: float) -> Search:
        if self._search.time_s is not None:
            return replace(self._search, time_s=self._search.time_s * share)
        return replace(self._search, simulations=max(round(self._search.simulations * share), 1))


def _values_of(plan: Plan) -> dict[str, Value]:
    return {value.action: Value.of(value) for value in plan.actions}


def best_of(values: Mapping[str, Value], but: str = "") -> str:
    """The action that is worth most of those that were tried at all."""
    tried = [name for name, value in values.items() if name != but and value.n > 0]
    return max(tried or values, key=lambda name: values[name].q)
