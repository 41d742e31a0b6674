"""The engines of the models that a mission had before, for one that is taken up."""

import logging
from collections.abc import Awaitable, Callable
from pathlib import Path

from msgspec.structs import replace

from aos_protocol.documents import Project
from aos_protocol.errors import AosError, ModelError
from aos_protocol.messages import MissionBegun
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine
from aos_solver.mission.models.takeover import Earlier, RunningModel
from aos_solver.mission.records.memory import MissionMemory
from aos_solver.mission.records.stretches import models_before
from aos_solver.settings import Settings

log = logging.getLogger(__name__)


async def built_for(
    begun: MissionBegun, project: Project, settings: Settings, on_progress: Callable[[str], None]
) -> BuiltModel:
    """The model of a revision's documents, with the values that the mission began with."""
    project = replace(project, constraints=settings.constraints, mission_values=())
    built = await build_project(project, Path(settings.cache_dir), on_progress)
    known = built.emitted.parameters
    values = {name: text for name, text in begun.mission_parameters.items() if name in known}
    return replace(built, mission_values=values)


async def earlier_models(
    memory: MissionMemory,
    running: RunningModel,
    documents: Callable[[int], Awaitable[Project]],
    settings: Settings,
    on_progress: Callable[[str], None],
) -> tuple[Earlier, ...]:
    """The models through which the belief of a mission comes to that of the running one, on initial beliefs.

    Empty where the running one replays the past by itself: no other model had handed a belief over, one of
    them cannot be made any more, or new documents have another state and nobody has used them yet.
    """
    begun, before = memory.begun, models_before(memory.stretches, running.digest, len(memory.steps))
    if begun is None or not before:
        return ()
    is_new = memory.stretches[-1].model_digest != running.digest
    found: list[Earlier] = []
    try:
        for stretch, until in before:
            built = await built_for(begun, await documents(stretch.revision), settings, on_progress)
            if built.emitted.digest != stretch.model_digest:
                raise ModelError(f"revision {stretch.revision} gives another model here")
            engine = await Engine.start(
                built, seed=begun.seed, impossible_observation=settings.impossible_observation
            )
            found.append(Earlier(RunningModel(stretch.revision, engine), until))
        if not is_new or found[-1].model.engine.state_digest == running.engine.state_digest:
            return tuple(found)
        log.info("revision %d has another state, and replays the mission", running.revision)
    except AosError as error:
        log.warning("the mission is replayed by revision %d alone: %s", running.revision, error)
    except BaseException:
        await _close(found)
        raise
    await _close(found)
    return ()


async def _close(found: list[Earlier]) -> None:
    for earlier in found:
        await earlier.model.engine.close()
