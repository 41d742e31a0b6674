from __future__ import annotations

import random
from collections.abc import Mapping
from pathlib import Path

import msgspec

from aos_language.load import load_files
from aos_protocol.messages import Activate, Fault, MissionState, Outcome
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.terms import Terms

from .jobs import Job

LIMITS = MissionLimits(goal_probability=0.9, step_limit=60)


class Played(msgspec.Struct, frozen=True):
    """A mission's ending, whether the world is at its goal, and the same of a robot without the broken skill.

    `is_spare_at_goal` is None where the job cannot be done without that skill.
    """

    name: str
    fault: str
    broken: str
    ending: str
    is_at_goal: bool
    steps: int
    is_spare_at_goal: bool | None = None

    @property
    def is_claimed(self) -> bool:
        return self.ending == "goal"

    @property
    def is_false_claim(self) -> bool:
        return self.is_claimed and not self.is_at_goal


async def played_job(job: Job, cache_dir: Path, simulations: int) -> Played:
    """Plays the job thrice in one world: with all skills, with one of those that were used broken, and with
    documents that lack it.
    """
    healthy = _Robot(job)
    await _mission(job.files, healthy, cache_dir, simulations)
    broken = random.Random(job.name).choice(sorted(healthy.used))
    robot = _Robot(job, broken)
    state = await _mission(job.files, robot, cache_dir, simulations)
    spare = None
    if (files := job.spare(broken)) is not None:
        spare = _Robot(job)
        await _mission(files, spare, cache_dir, simulations)
    return Played(
        job.name, job.fault, broken, state.ending, robot.is_at_goal, state.step, spare and spare.is_at_goal
    )


async def _mission(
    files: Mapping[str, str], robot: _Robot, cache_dir: Path, simulations: int
) -> MissionState:
    loaded = load_files({name: text.encode() for name, text in files.items()})
    assert loaded.project is not None, loaded.diagnostics
    built = await build_project(loaded.project, cache_dir)
    async with await Engine.start(built, seed=1) as engine:
        await robot.start(engine)
        terms = Terms(
            name="exam",
            limits=LIMITS,
            search=Search(simulations=simulations, seed=1),
            activation_timeout_s=1.0,
        )
        return await Mission(terms, RunningModel(1, engine), robot).run()


class _Robot(QuietPorts):
    """The mission's ports: skills act in the engine's world, but for the broken one."""

    def __init__(self, job: Job, broken: str = ""):
        self._job = job
        self._broken = broken
        self.is_at_goal = False
        self.used: set[str] = set()

    async def start(self, engine: Engine):
        self._engine = engine
        start = await engine.reset_world(random.Random(self._job.name).randrange(2**31))
        self.is_at_goal = start.ending == "goal"

    async def activate(self, request: Activate, action: str) -> Outcome:
        self.used.add(request.skill)
        if request.skill != self._broken:
            return Outcome(request.id, request.skill, "observed", await self._act(action))
        if self._job.fault == "fails":
            return _without_observation(request, "failed", "AOS510", "the gripper is jammed")
        if self._job.fault == "talks_nonsense":
            return Outcome(request.id, request.skill, "observed", self._job.nonsense)
        if self._job.did_run:
            await self._act(action)
        return _without_observation(request, "timed_out", "AOS503", "the skill took longer than it may")

    async def _act(self, action: str) -> str:
        """Steps the world, unless it has ended; the response."""
        names = [grounded.name for grounded in self._engine.description.actions]
        step = await self._engine.step_world(names.index(action))
        self.is_at_goal = self.is_at_goal or step.ending == "goal"
        return step.response


def _without_observation(request: Activate, status: str, code: str, text: str) -> Outcome:
    return Outcome(request.id, request.skill, status, fault=Fault(code, text))
