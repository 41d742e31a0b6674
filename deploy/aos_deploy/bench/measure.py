"""What is asked of our own engine: rates, and returns of whole missions."""

from __future__ import annotations

from collections.abc import Callable

from aos_deploy.bench.problems import Problem
from aos_solver.child.engine import Engine, Planner
from aos_solver.endings import MissionLimits
from aos_solver.search import Search
from aos_solver.simulation import simulate_mission

__all__ = ["SIMULATIONS", "discounted_returns", "sampling_rate", "search_rate", "threaded_search_rate"]

SIMULATIONS = 65_536
"""Of one search from a fresh root, here and in the baselines."""

_NEVER = 2.0
"""A probability that no belief reaches: a mission ends when its world does."""


async def sampling_rate(engine: Engine, repetitions: int, seconds: float, seed: int) -> list[float]:
    """Samples of (next state, observation, reward) with random actions, per second of processor time."""
    counts = [await engine.rate(seconds, seed + turn) for turn in range(repetitions)]
    return [count.samples / count.cpu_seconds for count in counts]


async def search_rate(engine: Engine, repetitions: int, seed: int) -> list[float]:
    """Simulations of POMCP from a fresh root at the initial belief, per second of processor time.

    A first search warms up.
    """
    rates = []
    for turn in range(repetitions + 1):
        await engine.reset_belief()
        plan = await engine.plan(simulations=SIMULATIONS, seed=seed + turn, planner="pomcp")
        rates.append(plan.simulations / plan.cpu_seconds)
    return rates[1:]


async def threaded_search_rate(engine: Engine, threads: int, repetitions: int, seed: int) -> list[float]:
    """The same with several threads at once, per second of real time."""
    rates = []
    for turn in range(repetitions + 1):
        await engine.reset_belief()
        plan = await engine.plan(simulations=SIMULATIONS, seed=seed + turn, planner="pomcp", threads=threads)
        rates.append(plan.simulations / plan.seconds)
    return rates[1:]


async def discounted_returns(
    engine: Engine,
    problem: Problem,
    planner: Planner,
    seeds: range,
    budget_s: float,
    on_run: Callable[[], None],
) -> list[float]:
    """Of one mission for each seed, planned with so much processor time for each step."""
    limits = MissionLimits(goal_probability=_NEVER, step_limit=problem.steps, stop_below_value=None)
    returns = []
    for seed in seeds:
        await engine.count_processor_time(True)  # in each, since a fault ends the child
        search = Search(simulations=0, seed=seed, time_s=budget_s, planner=planner)
        returns.append((await simulate_mission(engine, search, limits)).discounted_return)
        on_run()
    return returns
