import random
from pathlib import Path
from statistics import fmean, stdev

from aos_deploy.bundles.engine import engine_of_bundle
from aos_solver.child.engine import Engine, Planner
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

from .told import Told

NEVER = 2.0
"""A probability that no belief reaches: a mission ends when its world does."""


async def told_of_bundle(
    bundle: Path, planner: Planner, *, missions: int, seed: int, seconds: float | None, simulations: int
) -> Told:
    """The value of the first decision and the returns of missions, as many decisions as the horizon has.

    The range is that from random actions to the missions' mean.
    """
    async with engine_of_bundle(bundle, seed) as engine:
        await engine.count_processor_time(True)
        horizon = engine.description.horizon
        limits = MissionLimits(goal_probability=NEVER, step_limit=horizon, stop_below_value=None)

        def search_of(number: int) -> Search:
            return Search(simulations=simulations, time_s=seconds, seed=number, planner=planner)

        await engine.reset_belief()
        plan = await search_of(seed).run(engine, 1)
        returns = [
            (await simulate_mission(engine, search_of(number), limits)).discounted_return
            for number in range(seed, seed + missions)
        ]
        at_random = [await _random_return(engine, number, horizon) for number in range(seed, seed + missions)]
    best = plan.best
    error = stdev(returns) / len(returns) ** 0.5 if len(returns) > 1 else 0.0
    width = max(abs(fmean(returns) - fmean(at_random)), 1e-9)
    return Told(
        bundle.name,
        plan.planner,
        best.q,
        best.stderr,
        fmean(returns),
        error,
        width,
        best.at_least,
        best.at_most,
    )


async def _random_return(engine: Engine, seed: int, horizon: int) -> float:
    source = random.Random(seed)
    await engine.reset_world(seed)
    discounted = 0.0
    for step in range(horizon):
        done = await engine.step_world(source.randrange(len(engine.description.actions)))
        discounted += engine.description.discount**step * done.reward
        if done.ending:
            break
    return discounted
