"""Missions of the real engine on a bundle: returns, the first decision's value, and what decisions take."""

import dataclasses
from pathlib import Path
from statistics import fmean, stdev

import msgspec
from processes import descendants

from aos_deploy.bundles.engine import engine_of_bundle
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine, Planner
from aos_solver.child.questions.missions import UNRESTRICTED, Restriction
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission


@dataclasses.dataclass(frozen=True)
class Decision:
    """A decision: its planner, and the processor time of the search and of what was prepared before it."""

    planner: str
    search_s: float
    preparation_s: float


@dataclasses.dataclass
class Played:
    """Returns of missions, their decisions, and the first one as it was told."""

    returns: list[float] = dataclasses.field(default_factory=list)
    decisions: list[Decision] = dataclasses.field(default_factory=list)
    updates_s: list[float] = dataclasses.field(default_factory=list)
    """The processor time of the engine's process from one decision of a mission to the next."""

    first: Plan | None = None

    def take(self, plan: Plan):
        self.first = self.first or plan
        self.decisions.append(Decision(plan.planner, plan.search_s, plan.preparation_s))

    @property
    def mean(self) -> float:
        return fmean(self.returns)

    @property
    def error(self) -> float:
        return stdev(self.returns) / len(self.returns) ** 0.5 if len(self.returns) > 1 else 0.0


class _Noted(Search, frozen=True, kw_only=True):
    """A search whose plans are noted. `decided_at_s` is the processor time that the engine had spent then."""

    played: Played
    decided_at_s: list[float] = msgspec.field(default_factory=list)

    async def run(self, engine: Engine, step: int, within: Restriction = UNRESTRICTED) -> Plan:
        if self.decided_at_s:
            self.played.updates_s.append(processor_s(engine) - self.decided_at_s.pop())
        plan = await super().run(engine, step, within)
        self.played.take(plan)
        self.decided_at_s.append(processor_s(engine))
        return plan


def processor_s(engine: Engine) -> float:
    threads = [
        file for pid in descendants(engine.pid) for file in Path(f"/proc/{pid}/task").glob("*/schedstat")
    ]
    return sum(int(thread.read_text().split()[0]) for thread in threads) / 1e9


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
