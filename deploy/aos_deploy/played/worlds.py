"""The world that the adapter `model` plays: what has come of it so far, and how a process comes to it again.

A mission that begins with the initial belief has a world of its own, drawn by the mission's seed. One that
keeps the belief of the mission before goes on in that mission's world.
"""

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_deploy.played.faults import FAILED_CALL
from aos_language.mission_parameters import mission_value, usable_values
from aos_protocol.codec import UNREADABLE
from aos_protocol.documents import MissionValue, Project
from aos_protocol.errors import StorageError
from aos_protocol.messages import MissionEntry
from aos_runtime.disk.mission_folders import mission_folder
from aos_solver.child.engine import Engine
from aos_solver.mission.conditions import built_with_conditions
from aos_solver.mission.succession import KEEP

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
