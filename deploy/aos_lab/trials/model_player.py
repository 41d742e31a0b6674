"""Missions against the documents' own model, each in an engine of its own: its seed alone decides it."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AsyncExitStack

import msgspec
from msgspec.structs import replace

from aos_deploy.bundles.files import project_of
from aos_deploy.deployment.reading import Deployment
from aos_deploy.places import cache_dir
from aos_lab.trials.trial import Trial
from aos_protocol.documents import Project
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import Ending, MissionLimits
from aos_solver.mission.simulation import simulate_mission
from aos_solver.offline.policy import following

DEFAULT_SIMULATIONS = 100_000
"""The number is that of the commands, where neither simulations nor a time is given."""


class ModelMissions(msgspec.Struct, frozen=True):
    """All that missions of the model depend on beside their seeds; it refers to no file.

    `world` plays the world where the robot's own documents do not.
    """

    project: Project
    limits: MissionLimits
    search: Search
    world: Project | None = None

    @classmethod
    def of(cls, deployment: Deployment, world: Deployment | None = None) -> ModelMissions:
        """Those of a deployment; DocumentError with all that is wrong with its documents."""
        limits = msgspec.convert(deployment.file.mission, MissionLimits, from_attributes=True)
        played = project_of(world, plays_world=True) if world is not None else None
        return cls(project_of(deployment), limits, _search(deployment), played)


class ModelPlayer:
    """Plays missions by the model of their documents, which is built once."""

    def __init__(self, missions: ModelMissions, model: BuiltModel, world: BuiltModel | None = None) -> None:
        self.missions = missions
        self.model = model
        self.world = world

    @classmethod
    async def prepared(
        cls, missions: ModelMissions, on_progress: Callable[[str], None] = lambda text: None
    ) -> ModelPlayer:
        """Compiles the model; ModelError if that fails."""
        model = await build_project(missions.project, cache_dir(), on_progress)
        if missions.world is None:
            return cls(missions, model)
        return cls(missions, model, await build_project(missions.world, cache_dir(), on_progress))

    async def close(self) -> None:
        """Nothing is left of a mission."""

    async def play(self, seed: int) -> Trial:
        """One mission. The same seed gives the same mission wherever the budget is one in simulations."""
        start = time.perf_counter()
        search = replace(self.missions.search, seed=seed)
        async with AsyncExitStack() as engines:
            engine = await Engine.start(self.model, seed=seed)
            engines.push_async_callback(engine.close)
            world = None
            if self.world is not None:
                world = await Engine.start(self.world, seed=seed, keeps_belief=False)
                engines.push_async_callback(world.close)
            run = await simulate_mission(engine, search, self.missions.limits, with_states=True, world=world)
            parameters = engine.description.mission_parameters
        return Trial(
            seed=seed,
            ending=str(run.ending),
            goal=run.world_ending == Ending.GOAL,
            actions=run.actions,
            responses=run.observations,
            states=run.states[1:],
            world_ending=str(run.world_ending or ""),
            value=run.discounted_return,
            seconds=time.perf_counter() - start,
            mission_parameters=parameters,
        )


def _search(deployment: Deployment) -> Search:
    solver = deployment.file.solver
    search = Search(
        simulations=solver.simulations or DEFAULT_SIMULATIONS,
        seed=solver.seed,
        time_s=solver.time_s,
        horizon=solver.horizon,
        plans_to_step_limit=solver.plans_to_step_limit,
        planner=solver.planner,
        threads=solver.threads,
    )
    return following(search, deployment.policy)
