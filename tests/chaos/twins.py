"""Twins of missions: what an engine believes whose process is killed, beside one that nobody disturbs."""

import asyncio
import contextlib
import logging
import random
import signal
from collections.abc import Awaitable, Callable
from pathlib import Path

from tests.chaos.judged import Disturbance, Report
from tests.chaos.up import send, write_deploy_file
from tests.processes import descendants

from aos_language.load import load_bundle
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine

STEPS = 40
_KILLED_WITH = 0.15
"""The probability that an engine is killed in a step."""
_KILLED_WITHIN_S = 0.02
_TAKEN_UP_WITH = 0.05
"""The probability that a new engine replays all steps before, as after the death of a solver."""
_OPENED_WITH = 0.1
_UNOBSERVED_WITH = 0.1

Update = Callable[[Engine], Awaitable[str]]


def twins(folder: Path, name: str, seed: int, cache: Path) -> Report:
    """Gives two engines the same outcomes, and kills one of them; their beliefs have to be the same.

    Every fourth pair has a sampled belief.
    """
    report = Report(name)
    write_deploy_file(folder, seed, 1, is_sampled=seed % 4 == 3)
    logging.getLogger("aos_solver").setLevel(logging.ERROR)  # It warns of each engine that was killed.
    asyncio.run(_compare(folder / "tiger", seed, cache, report))
    return report


async def _compare(bundle: Path, seed: int, cache: Path, report: Report):
    project = load_bundle(bundle).project
    assert project is not None
    built = await build_project(project, cache)
    chance = random.Random(f"twins {seed}")
    past: list[Update] = []
    twin, disturbed = await _started(built, seed), await _started(built, seed)
    try:
        for step in range(1, STEPS + 1):
            if chance.random() < _TAKEN_UP_WITH:
                await disturbed.close()
                disturbed = await _started(built, seed)
                for update in past:
                    await update(disturbed)
            past.append(_outcome(chance, step))
            updating = asyncio.create_task(past[-1](disturbed))
            if chance.random() < _KILLED_WITH:
                await asyncio.sleep(chance.uniform(0.0, _KILLED_WITHIN_S))
                _kill(disturbed, chance)
                report.disturbances.append(Disturbance("twin's engine killed"))
            if await updating != await past[-1](twin):
                report.faults.append(f"after step {step} the twins believe different things")
                return
            report.beliefs += 1
    finally:
        await twin.close()
        await disturbed.close()


def _outcome(chance: random.Random, step: int) -> Update:
    """An outcome by chance; it gives the digest of the belief after it."""
    drawn, response = chance.random(), chance.choice(("tiger_left", "tiger_right"))

    async def update(engine: Engine) -> str:
        if drawn < _UNOBSERVED_WITH:
            left = await engine.update_without_observation("listen", ran_probability=0.5, step=step)
            return left.summary.digest
        if drawn < _UNOBSERVED_WITH + _OPENED_WITH:
            return (await engine.update("open(door=left_door)", "opened", step=step)).summary.digest
        return (await engine.update("listen", response, step=step)).summary.digest

    return update


async def _started(built: BuiltModel, seed: int) -> Engine:
    return await Engine.start(built, seed=seed)


def _kill(engine: Engine, chance: random.Random):
    with contextlib.suppress(FileNotFoundError):
        if engine.pid is not None:
            send(chance.choice([engine.pid, *descendants(engine.pid)]), signal.SIGKILL)
