"""Missions of a whole system, as `aos-up` runs them, of a script, and against the documents' own model.

A script's actions run one after the other in a simulated world, without services. The world's physics play
the skills. The documents' mappings, in their sandboxed workers, say what came back. Topics are read at the
end of each skill. Each mission against the model has an engine of its own, and its seed alone decides it.
"""

from __future__ import annotations

import asyncio
import json
import shutil
import time
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_deploy.bundles.files import project_of
from aos_deploy.deployment.adapter_kinds import check_installed
from aos_deploy.deployment.reading import Deployment
from aos_deploy.missions.mission_run import MissionRun
from aos_deploy.places import cache_dir
from aos_deploy.processes.needed_here import check_needed_here
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import Summary
from aos_lab.trials.trial import Trial, truth_lines
from aos_middleware.mappings.revisions import emit_project
from aos_middleware.workers.evaluator import EvaluationLimits, Evaluator
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, DeployError
from aos_runtime.clock import SystemClock
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child.answers.models import GroundedAction
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import Ending, MissionLimits
from aos_solver.mission.simulation import simulate_mission
from aos_solver.offline.policy import following


class ScriptPlayer:
    """Plays the same actions in a fresh world for each seed."""

    def __init__(
        self, deployment: Deployment, project: Project, script: Sequence[GroundedAction], out: Path
    ) -> None:
        from aos_skills.pybullet.world_file import load_world_file

        assert deployment.world is not None
        self._world_file = load_world_file(deployment.world)
        self._script = tuple(script)
        self._paths = {skill.name: skill.mapping.activation.path for skill in project.skills}
        used = {action.skill for action in script}
        self._evaluators = {
            emitted.skill: Evaluator(emitted, out / "mappings.log", EvaluationLimits())
            for emitted in emit_project(project)
            if emitted.skill in used
        }

    @classmethod
    async def prepared(cls, deployment: Deployment, script: Sequence[str], out: Path) -> ScriptPlayer:
        """Prepares a player; DeployError where there is no simulated world, or no such action."""
        if deployment.world is None:
            raise DeployError(
                f"{deployment.path} names no world for a script", hint="Name a world file under `world:`"
            )
        for adapter in deployment.adapters:
            check_installed(adapter.name, adapter.kind)
        player = await ModelPlayer.prepared(ModelMissions.of(deployment))
        async with await Engine.start(player.model, seed=1, keeps_belief=False) as engine:
            actions = {action.name: action for action in engine.description.actions}
        for name in script:
            if name not in actions:
                hint = f"Known are {', '.join(actions)}"
                raise DeployError(f"the script's action {name} is none of the documents'", hint=hint)
        return cls(deployment, player.missions.project, [actions[name] for name in script], out)

    async def play(self, seed: int) -> Trial:
        """One mission; one that broke is a trial with its fault."""
        start = time.perf_counter()
        world = self._world_file.build(seed)
        responses: list[str] = []
        states: list[str] = []
        fault = ""
        try:
            for step, action in enumerate(self._script, 1):
                response, fields = await self._response(world, action)
                responses.append(response)
                states.append(json.dumps(world.record(step, self._paths[action.skill], fields)))
        except AosError as error:
            fault = str(error)
        finally:
            world.close()
        return Trial(
            seed=seed,
            ending="fault" if fault else "scripted",
            goal=False,
            actions=tuple(action.name for action in self._script[: len(responses)]),
            responses=tuple(responses),
            states=tuple(states),
            seconds=time.perf_counter() - start,
            fault=fault,
        )

    async def close(self) -> None:
        """Ends the mappings' workers."""
        for evaluator in self._evaluators.values():
            await evaluator.close()

    async def _response(self, world: Any, action: GroundedAction) -> tuple[str, dict[str, Any]]:
        """Calls the skill and returns what came back, and the fields that it was called with."""
        evaluator = self._evaluators[action.skill]
        fields = await evaluator.begin(action.parameters)
        world.begin()
        answer = self._world_file.kind.skills[self._paths[action.skill]](world, fields)
        world.stop()
        await evaluator.take(list(world.sensors().items()))
        return (await evaluator.finish(answer)).response or "", fields


MISSION_S = 1800.0
"""A mission that takes longer is ended, and counts as broken."""


class SystemPlayer:
    """Plays missions of a deployment by its adapters; their run directories go below `runs`."""

    def __init__(self, deployment: Deployment, runs: Path) -> None:
        check_needed_here(deployment)
        self.deployment = deployment
        self._runs = runs

    async def close(self) -> None:
        """Nothing is left of a mission."""

    async def play(self, seed: int) -> Trial:
        """One mission; one that broke is a trial with its fault."""
        runs = self._runs / f"seed-{seed}"
        shutil.rmtree(runs, ignore_errors=True)
        file = self.deployment.file
        file = replace(file, solver=replace(file.solver, seed=seed))
        deployment = replace(self.deployment, file=file, runs=runs)
        mission = MissionRun(deployment, lambda event: None, SystemClock())
        try:
            summary = await asyncio.wait_for(mission.run(), MISSION_S)
            run = RunDirectory.latest(runs)
        except (AosError, TimeoutError) as error:
            fault = str(mission.error or error) or f"it did not end within {MISSION_S:g} s"
            return Trial(seed=seed, ending="fault", goal=False, fault=fault)
        return _trial(seed, summary, run.path)


def _trial(seed: int, summary: Summary, run: Path) -> Trial:
    return Trial(
        seed=seed,
        ending=summary.ending,
        goal=summary.ending == "goal",
        actions=summary.actions,
        responses=summary.responses,
        states=tuple(truth_lines(run)),
        seconds=summary.duration_s,
        fault=summary.remark if summary.ending in ("fault", "not_started", "cancelled") else "",
        mission_parameters=summary.mission_parameters,
    )


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
