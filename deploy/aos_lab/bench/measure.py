"""The measurements of our own engine: rates, and returns of whole missions."""

from collections.abc import Callable, Mapping

from aos_lab.bench.problems import Problem
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine, Planner, Stepping
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

SIMULATIONS = 65_536
"""Descents of one search from a fresh root, about; in the baselines just as many."""

THREADED_SEARCH_S = 0.3
"""The time of a search by one thread that several are compared with: long beside the start of a thread,
which may wait some milliseconds for a core."""

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
    """Descents of POMCP from a fresh root at the initial belief, per second of processor time.

    A first search warms up.
    """
    rates = []
    simulations = await _simulations_for(engine, seed)
    for turn in range(repetitions + 1):
        await engine.reset_belief()
        plan = await engine.plan(simulations=simulations, seed=seed + turn, planner="pomcp")
        rates.append(_descents(plan) / plan.cpu_seconds)
    return rates[1:]


async def _simulations_for(engine: Engine, seed: int) -> int:
    """The budget that `SIMULATIONS` descents use up, about: a simulation may be several of these."""
    await engine.reset_belief()
    sample = SIMULATIONS // 16
    sizing = await engine.plan(simulations=sample, seed=seed, planner="pomcp")
    return max(1, round(sample * SIMULATIONS / max(_descents(sizing), 1)))


def _descents(plan: Plan) -> int:
    """Returns the number of descents in a search from a fresh root."""
    return sum(action.n for action in plan.actions)


async def threaded_search_rates(
    engines: Mapping[int, Engine], repetitions: int, seed: int
) -> dict[int, list[float]]:
    """Descents per second of real time, by the number of threads, for each of which there is an engine.

    The engines search in turns. A first search of each warms up.
    """
    least = await _simulations_for(engines[1], seed)
    await engines[1].reset_belief()
    sizing = await engines[1].plan(simulations=least, seed=seed, planner="pomcp")
    simulations = max(least, round(THREADED_SEARCH_S * sizing.simulations / sizing.cpu_seconds))
    rates: dict[int, list[float]] = {threads: [] for threads in engines}
    for turn in range(repetitions + 1):
        for threads, engine in engines.items():
            await engine.reset_belief()
            plan = await engine.plan(
                simulations=simulations, seed=seed + turn, planner="pomcp", threads=threads
            )
            rates[threads].append(_descents(plan) / plan.seconds)
    return {threads: known[1:] for threads, known in rates.items()}


async def discounted_returns(
    engine: Engine,
    problem: Problem,
    planner: Planner,
    seeds: range,
    budget_s: float,
    on_run: Callable[[], None],
) -> list[float]:
    """Plays one mission for each seed, with so much processor time for each step, and returns their
    returns."""
    limits = MissionLimits(goal_probability=_NEVER, step_limit=problem.steps, stop_below_value=None)
    returns = []
    for seed in seeds:
        await engine.count_processor_time(True)  # in each, since a fault ends the child
        search = Search(simulations=0, seed=seed, time_s=budget_s, planner=planner)
        returns.append((await simulate_mission(engine, search, limits)).discounted_return)
        on_run()
    return returns
