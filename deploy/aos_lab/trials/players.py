"""Missions of a whole system, as `aos-up` runs them, and of a script: its actions one after the other in a
simulated world, without services.

The world's physics play the skills of a script. The documents' mappings, in their sandboxed workers, say what
came back. Topics are read at the end of each skill.
"""

from __future__ import annotations

import asyncio
import json
import shutil
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from aos_deploy.deployment.adapter_kinds import check_installed
from aos_deploy.deployment.reading import Deployment
from aos_deploy.missions.mission_run import MissionRun
from aos_deploy.processes.needed_here import check_needed_here
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import Summary
from aos_lab.trials.model_player import ModelMissions, ModelPlayer
from aos_lab.trials.trial import Trial, truth_lines
from aos_middleware.mappings.revisions import emit_project
from aos_middleware.workers.evaluator import EvaluationLimits, Evaluator
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, DeployError
from aos_runtime.clock import SystemClock
from aos_solver.child.answers.models import GroundedAction
from aos_solver.child.engine import Engine


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
