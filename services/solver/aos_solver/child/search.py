"""The planning budget of a mission, and the seed of each decision."""

from __future__ import annotations

import msgspec
from msgspec.structs import replace

from aos_protocol.messages import ChosenBy
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine
from aos_solver.child.questions.missions import DEFAULT_PLANNER, UNRESTRICTED, Planner, Restriction

SEEDS_PER_MISSION = 1000


class Search(msgspec.Struct, frozen=True, kw_only=True):
    """The budget of one decision: `time_s` if given, else `simulations`. `horizon` None is the document's.

    After `step_limit` decisions the mission is over. With `plans_to_step_limit` what cannot come before is
    worth nothing; else the limit only guards against a mission that goes on too long.

    With a budget in time the search can go on while an action is carried out (`ponder_while_acting`). With a
    budget in simulations it never does: how far it came would depend on the machine, and decisions would not
    repeat.
    """

    simulations: int
    seed: int
    time_s: float | None = None
    horizon: int | None = None
    step_limit: int | None = None
    plans_to_step_limit: bool = False
    planner: Planner = DEFAULT_PLANNER
    threads: int = 1
    ponder_while_acting: bool = True

    @property
    def chosen_by(self) -> ChosenBy:
        """The word for who chooses by this way of deciding."""
        return "planner"

    def seed_of(self, step: int) -> int:
        """The seed of decision `step`, in 64 bits, so that missions with neighbouring seeds share none."""
        return (self.seed * SEEDS_PER_MISSION + step) % 2**64

    def whole_horizon(self, engine: Engine) -> int:
        """The number of decisions that a decision looks ahead, itself among them, far from the step limit."""
        return self.horizon or engine.description.horizon

    def horizon_at(self, step: int, engine: Engine) -> int:
        """The number of decisions that decision `step` looks ahead, itself among them."""
        horizon = self.whole_horizon(engine)
        if self.step_limit is None or not self.plans_to_step_limit:
            return horizon
        return max(min(horizon, self.step_limit + 1 - step), 1)

    def after_takeover(self) -> Search:
        """The way to decide with a model that has taken over."""
        return self

    async def run(self, engine: Engine, step: int, within: Restriction = UNRESTRICTED) -> Plan:
        """Decide on what the engine believes, with what the restriction leaves."""
        ahead = self.horizon_at(step, engine)
        plan = await engine.plan(
            simulations=None if self.time_s is not None else self.simulations,
            time_s=self.time_s,
            seed=self.seed_of(step),
            horizon=ahead,
            planner=self.planner,
            threads=self.threads,
            within=within,
        )
        if ahead == self.whole_horizon(engine):
            return plan
        decisions = "one decision" if ahead == 1 else f"{ahead} decisions"
        return replace(plan, why=f"{plan.why}; the step limit leaves {decisions}")

    async def ponder(self, engine: Engine, step: int, index: int) -> None:
        """Look ahead below the action of decision `step` while it is carried out, if that is wanted."""
        if self.time_s is not None and self.ponder_while_acting:
            await engine.ponder(index, seed=self.seed_of(step), time_s=self.time_s, threads=self.threads)
