"""Bundles of documents through the real compiler and the real engine, against the truth."""

import dataclasses
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from aos_language.load import load_files
from aos_protocol.errors import AosError
from aos_solver.building.build import build
from aos_solver.child.engine import Engine
from aos_solver.emission.emit import emit
from aos_solver.emission.lowering.lower import lower
from aos_solver.emission.lowering.relevance import irrelevant_variables

from .documents import Documents
from .driver import Driver
from .problem import RUNNING, Problem, World, tabulate

_RESPONSES = {"yes": 0, "no": 1}


class Examined(msgspec.Struct, frozen=True):
    """The result of a bundle: what is false, and the worst decision in percent of what actions differ by."""

    name: str
    idioms: tuple[str, ...]
    false: tuple[str, ...] = ()
    decisions: int = 0
    worst: float = 0.0


def left_out(bundle: Documents) -> frozenset[str]:
    """The variables that matter and that the solver leaves out all the same; all of them are mistakes."""
    loaded = load_files({name: text.encode() for name, text in bundle.files.items()})
    assert loaded.project is not None, (bundle.name, loaded.diagnostics)
    return irrelevant_variables(loaded.project) & bundle.relevant


async def examined(
    bundle: Documents, truth: Driver, cache_dir: Path, planner: str, simulations: int
) -> Examined:
    """Plays a mission with each setting, and asks for exact values and a plan at each of its beliefs."""
    loaded = load_files({name: text.encode() for name, text in bundle.files.items()})
    assert loaded.project is not None, (bundle.name, loaded.diagnostics)
    if wrong := left_out(bundle):
        return Examined(
            bundle.name, bundle.idioms, (f"left out, but they matter: {', '.join(sorted(wrong))}",)
        )
    program, diagnostics = lower(loaded.project)
    if program is None:
        return Examined(bundle.name, bundle.idioms, (f"refused: {diagnostics[0].message}",))
    try:
        built = await build(emit(program), cache_dir=cache_dir)
    except AosError as error:
        return Examined(bundle.name, bundle.idioms, (str(error),))
    engine = await Engine.start(built, seed=1)
    try:
        return await _missions(bundle, truth, engine, planner, simulations)
    except AosError as error:
        return Examined(bundle.name, bundle.idioms, (str(error),))
    finally:
        await engine.close()


async def _missions(
    bundle: Documents, truth: Driver, engine: Engine, planner: Any, simulations: int
) -> Examined:
    found = []
    for values, world in bundle.settings:
        await engine.start_with(values)
        found.append(await _mission(bundle, world, truth, engine, planner, simulations))
    return Examined(
        bundle.name,
        bundle.idioms,
        tuple(false for each in found for false in each.false),
        sum(each.decisions for each in found),
        max(each.worst for each in found),
    )


async def _mission(
    bundle: Documents, world: World, truth: Driver, engine: Engine, planner: Any, simulations: int
) -> Examined:
    source = random.Random(bundle.name)
    problem = tabulate(bundle.name, world, 10_000)
    false: list[str] = []
    decisions, worst = 0, 0.0
    # The problem goes on from running states alone. In the engine's belief ended states stay and are worth 0.
    running = 1.0
    for step in range(world.horizon):
        brackets = truth.report(problem)["values"]
        claimed = [value.q / running for value in (await engine.exact_values()).actions]
        false += [
            f"step {step}: exact value of action {action} is {value!r}, but it is {bracket}"
            for action, (value, bracket) in enumerate(zip(claimed, brackets, strict=True))
            if not bracket[0] - 1e-6 <= value <= bracket[1] + 1e-6
        ]
        plan = await engine.plan(simulations=simulations, seed=step + 1, planner=planner)
        best = max(lower for lower, _ in brackets)
        spread = max(best - min(upper for _, upper in brackets), 1e-9)
        worst = max(worst, (best - brackets[plan.index][1]) / spread)
        decisions += 1
        # To look at beliefs that a good planner would end the mission before, too.
        action = plan.index if source.random() < 0.3 else 0
        following = dict(_following(problem, action))
        if not following:
            break
        response = source.choice(sorted(following))
        names = {number: name for name, number in _RESPONSES.items()}
        update = await engine.update(engine.description.actions[action].name, names[response])
        if update.is_impossible:
            false.append(f"step {step}: {names[response]} is held impossible")
            break
        summary = update.summary
        running = 1 - summary.goal_probability - summary.failure_probability - summary.over_probability
        problem = following[response]
    return Examined(bundle.name, bundle.idioms, tuple(false), decisions, 100 * worst)


def _following(problem: Problem, action: int) -> Iterator[tuple[int, Problem]]:
    weights: dict[int, dict[int, float]] = {}
    for state, share in problem.starts:
        for odds, after, sensing, _ in problem.rows[state, action]:
            if problem.states[after][1] != RUNNING:
                continue
            for response, likelihood in problem.sensings[sensing]:
                found = weights.setdefault(response, {})
                found[after] = found.get(after, 0.0) + share * odds * likelihood
    for response, found in weights.items():
        total = sum(found.values())
        yield (
            response,
            dataclasses.replace(problem, starts=[(state, weight / total) for state, weight in found.items()]),
        )
