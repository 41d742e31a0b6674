"""The shelf of models under random interleavings: no engine is asked after its end, and none is left."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import random
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any

from aos_protocol.documents import Project
from aos_protocol.errors import AosError, ModelError
from aos_protocol.messages import BeliefSummary, ProjectRevision
from aos_solver.building.thorough_builds import ThoroughBuilds
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.emission.layout import Layout
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.past import Evidence, Past
from aos_solver.mission.models.takeover import RunningModel

SUMMARY = BeliefSummary((), 0.0, 0.0, 0.0, 1, True)
LAYOUTS = tuple(Layout(dict.fromkeys(names, "bool"), frozenset(names)) for names in ("ab", "abc", "xyz"))
"""The first two have variables in common, the last one has none with them."""

_MANY_TURNS = 20_000


class _Engine:
    """An engine without a child: it takes its time, may fail, and notices who asks it after its end."""

    texting_skills = frozenset[str]()
    description = SimpleNamespace(responses={"act": ("done",)}, mission_parameters={})
    parameters = MappingProxyType[str, Any]({})

    def __init__(self, world: _World, digest: str):
        self._world = world
        self.is_closed = False
        self.model_digest = digest
        kind = int(digest) % len(LAYOUTS)
        self.layout, self.state_digest = LAYOUTS[kind], str(kind)
        # The steps that its belief is the posterior of; an imported one tells those of the engine before.
        self.known = 0

    async def start_with(self, _: object):
        await self._works()

    def has_action(self, _: str) -> bool:
        return True

    async def _works(self, may_fail: bool = True):
        if self.is_closed:
            self._world.faults.append(f"model {self.model_digest} was asked after its end")
        await self._world.turn()
        if may_fail and self._world.chance.random() < self._world.failing:
            raise ModelError("the code fails")

    async def summary(self) -> BeliefSummary:
        await self._works()
        return SUMMARY

    async def marginals(self) -> tuple[()]:
        await self._works()
        return ()

    async def export_beliefs(self) -> int:
        await self._works()
        return self.known

    async def import_beliefs(self, known: int) -> BeliefSummary:
        await self._works()
        self.known = known
        return SUMMARY

    async def export_joint(self, _: object) -> int:
        await self._works()
        return self.known

    async def project(self, known: int, _: object) -> BeliefSummary:
        await self._works()
        self.known = known
        return SUMMARY

    async def reset_belief(self) -> BeliefSummary:
        await self._works()
        self.known = 0
        return SUMMARY

    async def update(self, *_: object, **__: object) -> BeliefUpdate:
        # The mission's own engine fails seldom: that ends the mission.
        await self._works(may_fail=self is not self._world.deciding or self._world.chance.random() < 0.01)
        self.known += 1
        return BeliefUpdate(0.0, self._world.chance.random() < self._world.failing, SUMMARY)

    async def close(self):
        self.is_closed = True
        await self._world.turn()


class _Shelf(ModelShelf):
    """The shelf, whose builds take a few turns of the loop in place of a compiler."""

    world: _World

    async def _built(self, project: Project) -> Any:
        await self.world.turn()
        if self.world.chance.random() < self.world.failing:
            raise ModelError("it does not compile")
        return project


class _NoBuilds(ThoroughBuilds):
    """Thorough builds that begin nothing: there is no text to compile."""

    def begin(self, _: object):
        pass


class _World:
    """A registry, a middleware and a mission, in one loop, that do what they do at random."""

    def __init__(self, seed: int):
        self.chance = random.Random(seed)
        self.failing = self.chance.choice((0.0, 0.05, 0.3))
        self.faults: list[str] = []
        self.taken: list[str] = []
        self.engines: list[_Engine] = []
        self.mapped = self.running = 0
        self.deciding: Any = None
        self.shelf = _Shelf(
            Path(), lambda remark: None, self._start, lambda revision: revision <= self.mapped
        )
        self.shelf.world = self
        self.shelf._thorough = _NoBuilds(Path())

    async def turn(self):
        """Lets the others go on, for some turns of the loop."""
        for _ in range(self.chance.randrange(4)):
            await asyncio.sleep(0)

    async def _start(self, built: Any) -> _Engine:
        engine = _Engine(self, built.digest)
        self.engines.append(engine)
        try:
            await self.turn()
            if self.chance.random() < self.failing:
                raise ModelError("the initial belief fails")
        except BaseException:
            await engine.close()
            raise
        return engine

    async def make(self, revision: int):
        project = SimpleNamespace(digest=str(self.chance.randrange(1000)), emitted=None, skills=())
        await self.shelf.make(ProjectRevision(revision, "", project))

    async def mission(self):
        """Decides, step by step, with the newest model; a model that fails ends it."""
        running = await self.shelf.first()
        past = Past()
        while True:
            takeover = await self.shelf.newest(running, past)
            if takeover is not None:
                if takeover.model.revision <= running.revision:
                    self.faults.append(f"revision {takeover.model.revision} after {running.revision}")
                if takeover.model.revision > self.mapped:
                    self.faults.append(f"revision {takeover.model.revision} without the middleware")
                self.taken.append(takeover.row.by)
                running = takeover.model
            self.running, self.deciding = running.revision, running.engine
            self._check(running, past)
            await self.turn()
            await running.engine.update("act", "done", None, {}, refuted_below=0.01)
            past.steps.append(Evidence("act", "act", "done"))

    def _check(self, running: RunningModel, past: Past):
        engine: Any = running.engine
        if engine.is_closed:
            self.faults.append(f"revision {running.revision} runs with an engine that has ended")
        if engine.known != len(past):
            self.faults.append(
                f"revision {running.revision} knows {engine.known} of {len(past)} steps, by {self.taken[-1:]}"
            )


async def faults_of_interleaving(seed: int) -> list[str]:
    """Plays pushes, cancels, faults and the end at random; what went wrong."""
    world = _World(seed)
    chance = world.chance
    tasks = [asyncio.create_task(world.mission())]
    revision = 0
    for _ in range(chance.randint(5, 40)):
        match chance.choice(("make", "map", "map", "turns", "turns", "turns", "cancel")):
            case "make":
                revision += 1
                tasks.append(asyncio.create_task(world.make(revision)))
            case "map":
                world.mapped = chance.randint(world.mapped, revision)
            case "cancel":
                chance.choice(tasks[1:] if len(tasks) > 1 and chance.random() < 0.9 else tasks).cancel()
            case "turns":
                for _ in range(chance.randrange(80)):
                    await asyncio.sleep(0)
    if chance.random() < 0.5:
        await _settle(world, tasks[0], revision + 1)
    # The mission ends before its shelf; what is made goes on until after.
    tasks[0].cancel()
    await asyncio.wait({tasks[0]})
    closing = asyncio.create_task(world.shelf.close())
    if chance.random() < 0.5:
        await closing
    for task in tasks:
        task.cancel()
    await asyncio.wait([*tasks, closing])
    await world.shelf.settled()
    for task in (*tasks, closing):
        with contextlib.suppress(asyncio.CancelledError, AosError):
            task.result()
    left = [engine.model_digest for engine in world.engines if not engine.is_closed]
    if left:
        world.faults.append(f"{len(left)} engines are left")
    return world.faults


async def _settle(world: _World, mission: asyncio.Task[None], revision: int):
    world.failing = 0.0
    await world.make(revision)
    world.mapped = revision
    for _ in range(_MANY_TURNS):
        if mission.done() or world.running == revision:
            return
        await asyncio.sleep(0)
    world.faults.append(f"revision {revision} was lost")


async def test_no_engine_is_asked_after_its_end_or_left(caplog):
    caplog.set_level(logging.CRITICAL)
    faults = {seed: await faults_of_interleaving(seed) for seed in range(150)}
    assert {seed: found for seed, found in faults.items() if found} == {}
