"""Missions of the real engine on a bundle: returns, the first decision's value, and what decisions take."""

import dataclasses
from pathlib import Path
from statistics import fmean, stdev

from aos_deploy.bundle_engine import engine_of_bundle
from aos_solver.child.answers import Plan
from aos_solver.child.engine import Engine, Planner
from aos_solver.child.mission_questions import UNRESTRICTED, Restriction
from aos_solver.child.search import Search
from aos_solver.mission.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

__all__ = ["Played", "played"]


@dataclasses.dataclass
class Played:
    """Returns of missions, planners and times of their decisions, and the first decision."""

    returns: list[float] = dataclasses.field(default_factory=list)
    times_s: list[float] = dataclasses.field(default_factory=list)
    """The processor time of each search, which the budget counts."""

    preparations_s: list[float] = dataclasses.field(default_factory=list)
    """The processor time of the lists and values before each search, which no budget counts."""

    planners: set[str] = dataclasses.field(default_factory=set)
    first: Plan | None = None

    def take(self, plan: Plan) -> None:
        """Adds a decision."""
        self.first = self.first or plan
        self.times_s.append(plan.search_s)
        self.preparations_s.append(plan.preparation_s)
        self.planners.add(plan.planner)

    @property
    def mean(self) -> float:
        return fmean(self.returns)

    @property
    def error(self) -> float:
        return stdev(self.returns) / len(self.returns) ** 0.5 if len(self.returns) > 1 else 0.0


class _Noted(Search, frozen=True, kw_only=True):
    """A search whose plans are noted."""

    played: Played

    async def run(self, engine: Engine, step: int, within: Restriction = UNRESTRICTED) -> Plan:
        plan = await super().run(engine, step, within)
        self.played.take(plan)
        return plan


async def played(bundle: Path, planner: Planner, time_s: float, seeds: range, step_limit: int) -> Played:
    """Plays a mission with each seed. A decision has so many seconds of processor time."""
    noted = Played()
    limits = MissionLimits(goal_probability=1, step_limit=step_limit)
    async with engine_of_bundle(bundle, seeds[0]) as engine:
        await engine.count_processor_time(True)
        for seed in seeds:
            search = _Noted(simulations=1, time_s=time_s, seed=seed, planner=planner, played=noted)
            run = await simulate_mission(engine, search, limits)
            noted.returns.append(run.discounted_return)
    return noted
