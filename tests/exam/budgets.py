"""The cost of a simulation in each planner, on bundles of documents, in processor time.

POMCP plays a mission of a few decisions on each bundle. The others decide on the same beliefs. A search
counts that has used a tenth of its budget or more: one that ends early, since nothing is left to find out,
costs next to nothing whatever a simulation costs.
"""

import argparse
import datetime
import platform
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from aos_lab.bench.rows import this_machine
from aos_language.load import load_bundle
from aos_protocol.errors import AosError
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine, Planner

PLANNERS: tuple[Planner, ...] = ("pomcp", "despot", "sarsop", "auto")
MOST = 3.0
"""A simulation may take this many times as long in one planner as in another."""
LEAST_USED = 0.1

_ROOT = Path(__file__).resolve().parents[2]
_FOLDERS = (
    _ROOT / "deploy/bundles",
    _ROOT / "deploy/bundles/bench",
    _ROOT.parent / "shared/bench",
    _ROOT.parent / "shared/corpus",
)
_ROOTS = (_ROOT, _ROOT.parent)
_DOCUMENTS = ("*.ef", "*.json")


class Cost(msgspec.Struct, frozen=True):
    """The cost of one planner's searches on one bundle.

    `planner` was asked for, `used` has decided. `counted` simulations took `search_s` of processor time;
    there are none where all searches ended early. `preparation_s` is the most that lists, values and first
    bounds took before a search, and `update_s` the most that a belief update took, in real time.
    """

    planner: str
    used: str
    counted: int
    search_s: float
    preparation_s: float
    update_s: float

    @property
    def each_us(self) -> float:
        return self.search_s / self.counted * 1e6 if self.counted else 0.0


async def costs_of(built: BuiltModel, simulations: int, decisions: int, seed: int) -> list[Cost]:
    script: list[tuple[str, str, dict[str, Any]]] = []
    costs = []
    for planner in PLANNERS:
        async with await Engine.start(built, seed=seed, keeps_belief=False) as engine:
            costs.append(await _cost(engine, planner, simulations, decisions, seed, script))
    return costs


async def _cost(
    engine: Engine,
    planner: Planner,
    simulations: int,
    decisions: int,
    seed: int,
    script: list[tuple[str, str, dict[str, Any]]],
) -> Cost:
    is_first = not script
    if is_first:
        await engine.reset_world(seed)
    counted, search_s, preparation_s, update_s = 0, 0.0, 0.0, 0.0
    used: list[str] = []
    for number in range(decisions):
        plan = await engine.plan(simulations=simulations, seed=seed + number, planner=planner)
        used += [plan.planner] if plan.planner not in used else []
        preparation_s = max(preparation_s, plan.preparation_s)
        if plan.simulations >= LEAST_USED * simulations:
            counted += plan.simulations
            search_s += plan.search_s
        if is_first:
            step = await engine.step_world(plan.index)
            if step.ending:
                break
            script.append((plan.best.action, step.response, dict(step.numbers)))
        elif number == len(script):
            break
        action, response, numbers = script[number]
        start_s = time.monotonic()
        await engine.update(action, response, numbers=numbers)
        update_s = max(update_s, time.monotonic() - start_s)
    return Cost(planner, "/".join(used), counted, search_s, preparation_s, update_s)


async def examine_budgets(arguments: argparse.Namespace, cache_dir: Path) -> int:
    """Prints a table in Markdown: microseconds a simulation, and who decided.

    The exit code is 1 if two planners differ by more than `MOST` on a bundle.
    """
    machine = this_machine("", arguments.seed, 0.0)
    date = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d")
    print(f"{arguments.simulations:,} simulations a decision, {arguments.decisions} decisions, on {date}:")
    print(f"{machine.processor}, {machine.cores} cores, load {machine.load:.1f}, {platform.system()}\n")
    print("| bundle | " + " | ".join(PLANNERS) + " | largest ratio | preparation | update |")
    print("| --- |" + " ---: |" * (len(PLANNERS) + 3), flush=True)
    too_many = 0
    for folder in arguments.bundle or _bundles():
        try:
            ratio = await _row(Path(folder), arguments, cache_dir)
        except AosError as error:
            print(f"| {_name(Path(folder))} | {error} |", flush=True)
            continue
        too_many += ratio > MOST
    print(f"\n{too_many} bundles on which planners differ by more than {MOST:g}")
    return 1 if too_many else 0


async def _row(folder: Path, arguments: argparse.Namespace, cache_dir: Path) -> float:
    loaded = load_bundle(folder)
    if loaded.project is None:
        print(f"| {_name(folder)} | no whole bundle |", flush=True)
        return 1.0
    built = await build_project(loaded.project, cache_dir)
    costs = await costs_of(built, arguments.simulations, arguments.decisions, arguments.seed)
    ratio = ratio_of(costs)
    cells = [f"{cost.each_us:.2f} {cost.used}" if cost.counted else f"({cost.used})" for cost in costs]
    preparation_s = max(cost.preparation_s for cost in costs)
    update_s = max(cost.update_s for cost in costs)
    figures = f"{ratio:.1f} | {preparation_s:.2f} s | {update_s:.2f} s |"
    print(f"| {_name(folder)} | {' | '.join(cells)} | {figures}", flush=True)
    return ratio


def ratio_of(costs: Sequence[Cost]) -> float:
    known = [cost.each_us for cost in costs if cost.counted]
    return max(known) / min(known) if known else 1.0


def _name(folder: Path) -> str:
    """Returns the path from the checkout, or from the folder beside it: no two bundles have the same name."""
    path = folder.absolute()
    return str(next((path.relative_to(root) for root in _ROOTS if path.is_relative_to(root)), path))


def _bundles() -> list[Path]:
    folders = [path for parent in _FOLDERS if parent.is_dir() for path in sorted(parent.iterdir())]
    return [path for path in folders if any(next(path.glob(kind), None) for kind in _DOCUMENTS)]
