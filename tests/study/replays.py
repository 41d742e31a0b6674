"""Missions of many kinds, each replayed: are all values, counts and beliefs the same?"""

import os
import signal
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from aos_language.load import read_bundle_files
from aos_solver.child.engine import Engine
from aos_solver.study.comparing import compared

from ..processes import descendants, until_ended
from .played import Beside, Files, Played, play

BUNDLES = Path(__file__).resolve().parents[2] / "deploy" / "bundles"


class _Kind(NamedTuple):
    """A model with a budget, and what happens meanwhile."""

    bundle: str
    budget: dict[str, Any]
    what: str = ""


_KINDS = (
    _Kind("armadillo-finer", {}),
    _Kind("armadillo-finer", {"planner": "pomcp", "simulations": 3000, "threads": 4}),
    _Kind("armadillo-rough", {"planner": "pomcp", "simulations": 2000}, "other documents"),
    _Kind("armadillo-rough", {"planner": "sarsop", "simulations": 2000}, "a killed engine"),
    _Kind("bench/laser-normal", {"simulations": 400}),
    _Kind("bench/laser-normal", {"simulations": 400, "threads": 4}, "a killed engine"),
    _Kind("bench/tiger", {"planner": "despot", "simulations": 1000}),
    _Kind("bench/maint10", {"simulations": 1000}),
    _Kind("bench/rocksample-7-8", {"simulations": 1000}),
    _Kind("bench/rocksample-7-8", {"planner": "pomcp", "time_s": 0.05}),
    _Kind("bench/tag", {"simulations": 500}, "a killed engine"),
    _Kind("turtlebot", {"simulations": 1000}),
)


def files_of(bundle: str) -> dict[str, bytes]:
    """The files of one of our bundles."""
    return read_bundle_files(BUNDLES / bundle)[0]


async def measure(runs: int, cache_dir: Path) -> bool:
    """Plays and replays so many missions, and prints a line for each kind."""
    same: Counter[_Name] = Counter()
    played: Counter[_Name] = Counter()
    decisions = with_values = beliefs = 0
    for number in range(runs):
        kind = _KINDS[number % len(_KINDS)]
        mission = await _play(kind, number + 1, cache_dir)
        name = f"{kind.bundle} {kind.budget} {kind.what}".strip()
        played[name] += 1
        difference = ""
        replay = mission.replay(decides=True)
        try:
            async for remade in replay.rows():
                row = compared(remade, replay.engine.build_digest, mission.settings.time_s)
                if row is not None:
                    decisions += row.decides
                    with_values += row.has_values
                    beliefs += row.has_belief
                    difference = difference or row.difference
        finally:
            await replay.close()
        same[name] += not difference
        if difference:
            print(f"seed {number + 1}, {name}: {difference}", flush=True)
    for name in played:
        print(f"{same[name]:4} of {played[name]:4} identical: {name}")
    print(
        f"{same.total()} of {runs} missions identical; of {decisions} decisions {with_values} in all values, "
        f"{beliefs} beliefs"
    )
    return same.total() == runs


_Name = str


async def _play(kind: _Kind, seed: int, cache_dir: Path) -> Played:
    files = files_of(kind.bundle)
    then: tuple[int, Files] | None = None
    if kind.what == "other documents":
        then = (2, files | {"pick.sd": files["pick.sd"].replace(b"__reward = -2", b"__reward = -3")})
    beside = Beside(disturbance=_kill if kind.what == "a killed engine" else None)
    return await play(files, cache_dir, seed=seed, steps=6, then=then, beside=beside, **kind.budget)


async def _kill(engine: Engine, step: int) -> None:
    """Kills the engine in its third step."""
    if step == 3 and engine.pid is not None:
        children = descendants(engine.pid)
        os.kill(engine.pid, signal.SIGKILL)
        await until_ended(children)
