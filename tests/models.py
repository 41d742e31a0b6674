from collections.abc import AsyncIterator, Collection, Mapping, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from projects import bundle_project, text_project

from aos_deploy.places import cache_dir
from aos_protocol.documents import Project
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine, ImpossiblePolicy, Planner
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import SimulatedRun, simulate_mission


async def built_project(project: Project) -> BuiltModel:
    """The compiled model, from the cache that commands use as well."""
    return await build_project(project, cache_dir())


async def built_bundle(bundle: Path) -> BuiltModel:
    return await built_project(bundle_project(bundle))


async def built_bundles(bundles: Sequence[Path], leave_out: Collection[str] = ()) -> BuiltModel:
    """The compiled model of several, without the skills that are left out; documents of a later bundle stand
    in place of those with the same name."""
    files = [file for bundle in bundles for file in sorted(bundle.iterdir()) if file.stem not in leave_out]
    return await built_text({file.name: file.read_text() for file in files})


async def built_text(files: Mapping[str, str]) -> BuiltModel:
    return await built_project(text_project(files))


@asynccontextmanager
async def engine_of(
    built: BuiltModel, *, seed: int = 1, impossible_observation: ImpossiblePolicy = "widen"
) -> AsyncIterator[Engine]:
    async with await Engine.start(built, seed=seed, impossible_observation=impossible_observation) as engine:
        yield engine


@asynccontextmanager
async def engine_of_text(files: Mapping[str, str], *, seed: int = 1) -> AsyncIterator[Engine]:
    async with engine_of(await built_text(files), seed=seed) as engine:
        yield engine


@asynccontextmanager
async def engine_of_bundle(bundle: Path, *, seed: int = 1) -> AsyncIterator[Engine]:
    async with engine_of(await built_bundle(bundle), seed=seed) as engine:
        yield engine


async def simulated(
    engine: Engine, simulations: int, *, seed: int = 1, planner: Planner = "auto", **limits: Any
) -> SimulatedRun:
    """A mission against the documents' own model; `limits` are those of `MissionLimits`."""
    search = Search(simulations=simulations, seed=seed, planner=planner)
    return await simulate_mission(engine, search, MissionLimits(**limits))
