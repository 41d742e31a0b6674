"""The cost of the sandbox: `python -m tests.hostile.cost`, of a child and of a decision."""

import asyncio
import statistics
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from aos_deploy.program import cache_dir
from aos_language.load import load_bundle
from aos_runtime.children import Confinement, Limits, guarded
from aos_runtime.sandbox.places import library_folders, loader_of
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child import engine_child
from aos_solver.child.engine import Engine

from .said import processor_s

BUNDLE = Path(__file__).resolve().parents[2] / "deploy" / "bundles" / "turtlebot"
CHILDREN = 100
ROUNDS = 15
DECISIONS = 20
SIMULATIONS = 20_000


def child_s(confinement: Confinement | None) -> float:
    """The processor time of a guarded program that does nothing, and of its guard."""
    command = guarded(["/bin/true"], Limits(), confinement)
    before_s = processor_s()
    subprocess.run(command, check=True)
    return processor_s() - before_s


async def decisions_s(built: BuiltModel) -> float:
    """The processor time of a row of decisions in a new engine."""
    engine = await Engine.start(built, seed=1)
    try:
        plans = [
            await engine.plan(seed=seed, simulations=SIMULATIONS, planner="pomcp")
            for seed in range(DECISIONS)
        ]
    finally:
        await engine.close()
    return sum(plan.cpu_seconds for plan in plans)


def alternating(first: Callable[[], float], second: Callable[[], float], times: int) -> tuple[float, float]:
    """The medians of both, which take turns so that other work on the machine reaches both."""
    pairs = [(first(), second()) for _ in range(times)]
    return statistics.median(one for one, _ in pairs), statistics.median(other for _, other in pairs)


def main() -> int:
    """Prints both costs; exit code 0."""
    loader = loader_of("/bin/true")
    confined = Confinement(profile="engine", read=library_folders(), execute=("/bin/true", loader))
    with_ms, without_ms = (
        1e3 * value for value in alternating(lambda: child_s(confined), lambda: child_s(None), CHILDREN)
    )
    more_ms = with_ms - without_ms
    print(f"a child: {with_ms:.1f} ms in the sandbox, {without_ms:.1f} ms without, {more_ms:.1f} ms more")
    project = load_bundle(BUNDLE).project
    assert project is not None
    built = asyncio.run(build_project(project, cache_dir()))
    sandbox = engine_child.confinement_of

    def measured(is_confined: bool) -> float:
        engine_child.confinement_of = sandbox if is_confined else lambda *paths: None
        return asyncio.run(decisions_s(built))

    with_s, without_s = alternating(lambda: measured(True), lambda: measured(False), ROUNDS)
    print(
        f"{DECISIONS} decisions: {with_s:.3f} s in the sandbox, {without_s:.3f} s without, "
        f"{100 * (with_s / without_s - 1):+.1f} %"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
