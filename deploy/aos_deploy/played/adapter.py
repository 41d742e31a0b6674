"""The adapter `model`: skills that are played by their own documents, where there is no robot.

All skills that are bound to it share one hidden true state, drawn from the initial belief by the mission's
seed and stepped by the model, as `aos simulate` does it. A call answers with the observation itself. The
truth of each step is in `<run>/<adapter>.jsonl`; the planner is not told. A process that starts again plays
the steps of that file once more, and so comes to the same state. With the option `faults` some calls fail.

In a system that stays each mission has such a file in its folder. A mission that begins with the initial
belief has a world of its own, drawn by the mission's seed. One that keeps the belief of the mission before
goes on in that mission's world.
"""

import asyncio
import logging
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_deploy.played.faults import FAILED_CALL, LOST_RESULT, NO_ANSWER, PlayedFaults
from aos_language.mission_parameters import mission_value, usable_values
from aos_protocol.codec import UNREADABLE
from aos_protocol.documents import MissionValue, Project
from aos_protocol.errors import AosError, SkillError, StorageError
from aos_protocol.messages import MissionEntry, ProjectRevision
from aos_runtime.adapters import Call, Host, Observed
from aos_runtime.disk.mission_folders import mission_folder, number_in
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine
from aos_solver.mission.conditions import built_with_conditions
from aos_solver.mission.succession import KEEP

__all__ = ["ModelAdapter", "PlayedStep"]

_log = logging.getLogger("aos.model")


class _World(msgspec.Struct, frozen=True):
    """A running model, and the number of each of its actions by skill and parameters."""

    engine: Engine
    project: Project
    names: tuple[str, ...]
    skills: dict[str, list[tuple[dict[str, Any], int]]]


class ModelAdapter:
    """Serves the paths of all skills that fall to it, as soon as their model is built."""

    version = "1"

    def __init__(self, host: Host) -> None:
        self._host = host
        self._cache_dir = Path(host.options["cache_dir"])
        self._file = host.run_dir / f"{host.name}.jsonl"
        self._mission_values = msgspec.convert(
            host.options.get("mission_values", ()), tuple[MissionValue, ...]
        )
        self._faults = PlayedFaults(host.options.get("faults", {}))
        self._worlds = [PlayedWorld(self._file, host.seed, self._mission_values)]
        self._mission = ""
        self._world: _World | None = None
        self._following: asyncio.Task[None] | None = None
        self._changing = asyncio.Lock()

    async def start(self) -> None:
        """Documents come after everything has started; a model takes its time to be compiled."""
        self._worlds = [replace(self._worlds[0], played=steps_in(self._file))]
        self._following = asyncio.create_task(self._follow())

    async def call(self, call: Call) -> Observed:
        """A step of the hidden state; SkillError where a fault was drawn for it."""
        await self._turn_to(call.id.mission)
        fault = self._faults.drawn(call.skill, self._worlds[-1].seed, call.id.step)
        # A step takes far less than its cancellation could: it is done or not begun.
        observed = await asyncio.shield(self._step(call, fault))
        if fault == FAILED_CALL:
            raise SkillError(f"{call.skill} has failed, as the test wants it", code="AOS510")
        if fault == LOST_RESULT:
            raise SkillError(f"the result of {call.skill} is lost, as the test wants it", code="AOS504")
        if fault == NO_ANSWER:
            await asyncio.Event().wait()
        return observed

    async def close(self) -> None:
        if self._following is not None:
            self._following.cancel()
            await asyncio.wait({self._following})
        if self._world is not None:
            await self._world.engine.close()

    async def _turn_to(self, mission: str) -> None:
        """Turns to the world of another mission, in a system that stays."""
        number = number_in(self._host.run_dir.name, mission)
        if mission == self._mission or number is None:
            return
        entries = (await self._host.missions()).entries
        async with self._changing:
            self._worlds = worlds_of(
                entries, number, self._host.run_dir, self._host.name, self._mission_values
            )
            if self._world is not None:
                self._world = await self._brought(self._world.engine, self._world.project)
            self._mission = mission

    async def _brought(self, engine: Engine, project: Project) -> _World:
        """The world to which the missions have come, with the actions that the mission's values give it."""
        await bring_to(engine, project, self._worlds, self._cache_dir)
        actions = engine.description.actions
        world = _World(engine, project, tuple(action.name for action in actions), {})
        for index, action in enumerate(actions):
            world.skills.setdefault(action.skill, []).append((action.parameters, index))
        return world

    async def _step(self, call: Call, fault: str) -> Observed:
        async with self._changing:
            world = self._world
            if world is None:
                raise SkillError("the model is not ready", code="AOS505")
            index = _index(world, call)
            name = world.names[index]
            if fault == FAILED_CALL:
                played = PlayedStep(name, "", 0.0, "", await world.engine.world_state(), fault)
                numbers: dict[str, Any] = {}
                monitors: dict[str, str] = {}
            else:
                step = await world.engine.step_world(index)
                state = await world.engine.world_state()
                played = PlayedStep(name, step.response, step.reward, step.ending, state, fault)
                numbers = step.numbers
                monitors = await world.engine.monitor_world()
                now = self._worlds[-1]
                self._worlds[-1] = replace(now, played=(*now.played, name))
        with self._worlds[-1].file.open("ab") as file:
            file.write(msgspec.json.encode(played) + b"\n")
        return Observed(played.response, numbers, monitors)

    async def _follow(self) -> None:
        async for revision in self._host.revisions():
            try:
                await self._adopt(revision)
            except AosError as error:
                _log.error("revision %d cannot be played: %s", revision.revision, error)
                if self._world is None:
                    await self._serve(revision.project)  # A mission that starts is told why it cannot.

    async def _adopt(self, revision: ProjectRevision) -> None:
        """Goes over to new documents: the steps so far are played again by them."""
        project = replace(revision.project, mission_values=self._mission_values)
        built = await build_project(project, self._cache_dir, lambda remark: _log.info("%s", remark))
        engine = await Engine.start(built, seed=self._host.seed, keeps_belief=False)
        async with self._changing:
            outdated, self._world = self._world, await self._brought(engine, revision.project)
        if outdated is not None:
            await outdated.engine.close()
        await self._serve(revision.project)

    async def _serve(self, project: Project) -> None:
        paths = {"/" + skill.mapping.activation.path.strip("/") for skill in project.skills}
        bound = {path for path in paths if path in self._host.bound or self._host.wants(path)}
        await self._host.serve(*sorted(bound))


def _index(world: _World, call: Call) -> int:
    for parameters, index in world.skills.get(call.skill, ()):
        if parameters == call.parameters:
            return index
    hint = "A model plays what a planner has decided; a call by hand does not say which action it is"
    raise SkillError(f"the model has no action {call.skill} with {call.parameters}", hint=hint)


MAX_DRAWS = 10_000
"""A world where what is given holds is drawn anew so often at most."""


class PlayedStep(msgspec.Struct, frozen=True):
    """One line of the file: what was done, what came of it, and the state after it as text.

    Its `fault` is what the mission was told in place of the response.
    """

    action: str
    response: str
    reward: float
    ending: str
    state: str
    fault: str = ""


class PlayedWorld(msgspec.Struct, frozen=True):
    """A mission in a world: how it began, its seed and values, the file of its steps, and the steps so far.

    One that `is_kept` goes on in the world before it.
    """

    file: Path
    seed: int
    values: tuple[MissionValue, ...] = ()
    is_kept: bool = False
    idle: int = 0
    given: tuple[str, ...] = ()
    played: tuple[str, ...] = ()


def steps_in(file: Path) -> tuple[str, ...]:
    """The actions that were done, as the file of the steps has them; none if it is not there.

    StorageError AOS702 for a line that is no step.
    """
    lines = file.read_bytes().splitlines() if file.exists() else []
    steps = [_step(file, number, line) for number, line in enumerate(lines, 1)]
    return tuple(step.action for step in steps if step.fault != FAILED_CALL)


def _step(file: Path, number: int, line: bytes) -> PlayedStep:
    try:
        return msgspec.json.decode(line, type=PlayedStep)
    except UNREADABLE as error:
        raise StorageError(f"{file}, line {number} is no step: {error}", code="AOS702") from error


def worlds_of(
    entries: Sequence[MissionEntry], number: int, run: Path, name: str, values: tuple[MissionValue, ...]
) -> list[PlayedWorld]:
    """The missions that a mission's world has gone through, itself the last, out of all of a system.

    `values` are set for missions that set no others. The steps are in `<name>.jsonl` of each folder.
    """
    found: list[PlayedWorld] = []
    for entry in entries[:number]:
        if entry.belief != KEEP:
            found = []
        file = mission_folder(run, entry.number) / f"{name}.jsonl"
        own = tuple(mission_value(key, text) for key, text in entry.values.items())
        found.append(
            PlayedWorld(
                file,
                entry.seed,
                (*values, *own),
                is_kept=bool(found),
                idle=entry.idle,
                given=entry.given,
                played=steps_in(file),
            )
        )
    return found


async def bring_to(engine: Engine, project: Project, worlds: Sequence[PlayedWorld], cache_dir: Path) -> None:
    """Brings the world of an engine to where the missions have come.

    Actions that the documents do not have any more are left out. AosError where the world cannot be drawn.
    """
    await engine.start_with(usable_values(worlds[-1].values, engine.parameters))
    places = {action.name: place for place, action in enumerate(engine.description.actions)}
    for world in worlds:
        if not world.is_kept:
            await engine.reset_world(await _seed(engine, project, world, cache_dir))
        if world.is_kept or world.idle:
            await engine.begin_mission_in_world(world.idle)
        for name in world.played:
            if name in places:
                await engine.step_world(places[name])
                await engine.monitor_world()


async def _seed(engine: Engine, project: Project, world: PlayedWorld, cache_dir: Path) -> int:
    """The seed of a world where that holds which is given; the mission's own where nothing is."""
    if not world.given:
        return world.seed
    built = await built_with_conditions(project, world.given, cache_dir)
    values = usable_values(world.values, engine.parameters)
    built = replace(built, mission_values=values)
    async with await Engine.start(built, seed=world.seed, keeps_belief=False) as aside:
        for draw in range(MAX_DRAWS):
            seed = world.seed + draw * 1_000_003
            await aside.reset_world(seed)
            start = await aside.begin_mission_in_world(world.idle)
            if start.conditions == (1 << len(world.given)) - 1:
                return seed
    return world.seed
