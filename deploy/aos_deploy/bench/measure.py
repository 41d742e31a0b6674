"""What is asked of our own engine: rates, and returns of whole missions."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from aos_deploy.bench.problems import Problem
from aos_solver.child.engine import Engine, Planner, Stepping
from aos_solver.endings import MissionLimits
from aos_solver.search import Search
from aos_solver.simulation import simulate_mission

__all__ = ["SIMULATIONS", "discounted_returns", "sampling_rate", "search_rate", "threaded_search_rates"]

SIMULATIONS = 65_536
"""Of one search from a fresh root, here and in the baselines."""

THREADED_SEARCH_S = 0.3
"""Of a search by one thread that several are compared with: long beside the start of a thread, which may wait
some milliseconds for a core."""

_NEVER = 2.0
"""A probability that no belief reaches: a mission ends when its world does."""


async def sampling_rate(
    engine: Engine, repetitions: int, seconds: float, seed: int, stepping: Stepping
) -> list[float]:
    """Samples of (next state, observation, reward) with random actions, per second of processor time.

    None where there is no table to step by.
    """
    counts = [await engine.rate(seconds, seed + turn, stepping) for turn in range(repetitions)]
    return [count.samples / count.cpu_seconds for count in counts if count.samples > 0]


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


async def threaded_search_rates(
    engines: Mapping[int, Engine], repetitions: int, seed: int
) -> dict[int, list[float]]:
    """Simulations per second of real time, by the number of threads, for each of which there is an engine.

    The engines search in turns. A first search of each warms up.
    """
    sizing = await engines[1].plan(simulations=SIMULATIONS, seed=seed, planner="pomcp")
    simulations = max(SIMULATIONS, round(THREADED_SEARCH_S * sizing.simulations / sizing.cpu_seconds))
    rates: dict[int, list[float]] = {threads: [] for threads in engines}
    for turn in range(repetitions + 1):
        for threads, engine in engines.items():
            await engine.reset_belief()
            plan = await engine.plan(
                simulations=simulations, seed=seed + turn, planner="pomcp", threads=threads
            )
            rates[threads].append(plan.simulations / plan.seconds)
    return {threads: known[1:] for threads, known in rates.items()}


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
