"""The desks of a solver: where operators steer the mission that runs, and where its missions are studied.

An operator is answered when the mission has turned. Where it is ended, what moves for it is cancelled, until
it has ended. A study has an engine of its own.
"""

import asyncio
import uuid
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from msgspec.structs import replace

from aos_protocol.documents import Project
from aos_protocol.errors import AosError, SteeringError
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    Cancel,
    Cancelled,
    DecisionTree,
    MissionState,
    Steer,
    StopMission,
    TreeQuery,
    WhatIf,
    WhatIfQuery,
    Why,
    WhyQuery,
)
from aos_runtime.bus.bus import Bus
from aos_runtime.disk.journal import rows_of
from aos_runtime.parties.registry_watch import RegistryWatch
from aos_runtime.parties.served import served
from aos_solver.mission.loop import Mission
from aos_solver.mission.records.logbook import Logbooks
from aos_solver.mission_runner import MissionRunner
from aos_solver.settings import Settings
from aos_solver.study.recorded import RecordedMission, recorded
from aos_solver.study.replaying import NICENESS, ReplayedMission
from aos_solver.study.study import Study

_SOMEBODY = "somebody"


class SteeringDesk:
    """Answers those who steer; `on_turn` wakes the mission."""

    def __init__(self, missions: MissionRunner, on_turn: Callable[[], None], bus: Bus, keys: Keys) -> None:
        self._missions = missions
        self._on_turn = on_turn
        self._bus = bus
        self._keys = keys

    async def stop(self, stop: StopMission) -> MissionState:
        """Ends the mission that runs, or keeps the one from beginning that is about to; returns when that is
        so."""
        if stop.mission in ("", self._missions.state.mission):
            await self._missions.give_up_start(stop.reason)
        mission = await self._missions.running()
        if mission is None or stop.mission not in ("", mission.state.mission):
            return self._missions.state
        return await self.take(Steer("stop", by=stop.by, reason=stop.reason))

    async def take(self, steer: Steer) -> MissionState:
        """Steers the mission that runs; the answer is as in Steer. SteeringError where it cannot be done."""
        mission = await self._missions.running()
        if mission is None and steer.verb == "stop":
            return await self.stop(
                StopMission(steer.mission, steer.reason or f"stopped by {steer.by}", steer.by)
            )
        if mission is None:
            is_first_to_come = self._missions.state.phase in ("waiting", "compiling")
            if is_first_to_come:
                hint = "Wait until its model is compiled, or begin one by `aos mission start`"
                raise SteeringError("no mission has begun", hint=hint)
            raise SteeringError("no mission runs", hint="See `aos mission list`")
        if steer.mission not in ("", mission.state.mission):
            raise SteeringError(f"{steer.mission} does not run, {mission.state.mission} does")
        steer = replace(steer, by=steer.by or _SOMEBODY, request=steer.request or uuid.uuid4().hex)
        mission.steer(steer)
        self._on_turn()
        if steer.verb == "act":
            await mission.until_decided(steer.request)
        elif steer.verb == "stop":
            await until_stopped(mission, steer.reason, self._missions.ended, self._bus, self._keys)
        return mission.state


CANCEL_AGAIN_S = 0.2
"""A mission that is stopped cancels again after this time: what it asked for may not have begun before."""
CANCEL_TIMEOUT_S = 5.0


async def until_stopped(mission: Mission, reason: str, ended: asyncio.Event, bus: Bus, keys: Keys) -> None:
    """Returns when a mission that was told to stop has ended, which `ended` tells."""
    while mission.state.phase != "ended":
        await _cancel(mission, reason, bus, keys)
        with suppress(TimeoutError):
            async with asyncio.timeout(CANCEL_AGAIN_S):
                await ended.wait()


async def _cancel(mission: Mission, reason: str, bus: Bus, keys: Keys) -> None:
    """Cancels what the mission has asked for, whoever serves it."""
    if mission.activation is None:
        return
    cancel = Cancel(reason, mission.activation, mission.state.epoch)
    # All at once: one that is slow to answer keeps nothing else moving.
    questions = [
        bus.ask(keys.cancel(path), cancel, Cancelled, timeout_s=CANCEL_TIMEOUT_S)
        for path in sorted({server.path for server in await served(bus, keys)})
    ]
    answers = await asyncio.gather(*questions, return_exceptions=True)
    for answer in answers:
        if isinstance(answer, BaseException) and not isinstance(answer, AosError):
            raise answer


_PATIENCE_S = 0.5
"""Whoever asks in a mission is not to wait for a compiler that gives way to everything else."""


class StudyDesk:
    """Answers questions about the missions in the logbooks, one after the other."""

    def __init__(self, settings: Settings, books: Logbooks, registry: RegistryWatch) -> None:
        source = _Logged(settings, books, registry)
        self._study = Study(source, Path(settings.cache_dir), NICENESS, patience_s=_PATIENCE_S)

    async def answer(self, bus: Bus, keys: Keys) -> None:
        await bus.answer(keys.study_why, WhyQuery, self._why)
        await bus.answer(keys.study_whatif, WhatIfQuery, self._what_if)
        await bus.answer(keys.study_tree, TreeQuery, self._tree)

    async def close(self) -> None:
        """Ends the engines of studies."""
        await self._study.close()

    async def _why(self, query: WhyQuery, _: str) -> Why:
        return await self._study.why(query)

    async def _what_if(self, query: WhatIfQuery, _: str) -> WhatIf:
        return await self._study.what_if(query)

    async def _tree(self, query: TreeQuery, _: str) -> DecisionTree:
        return await self._study.tree(query)


class _Logged:
    """The missions of the solver, as their journals are now, and the registry's documents."""

    def __init__(self, settings: Settings, books: Logbooks, registry: RegistryWatch) -> None:
        self._settings = settings
        self._books = books
        self._registry = registry

    async def recorded(self, mission: str) -> RecordedMission:
        return await asyncio.to_thread(_read, self._books.path_of(mission))

    def replay(self, mission: RecordedMission) -> ReplayedMission:
        policy = Path(self._settings.policy) if self._settings.policy else None
        return ReplayedMission(mission, self, self._settings, policy=policy)

    async def revision(self, number: int) -> Project:
        return await self._registry.documents(number)

    async def files(self, revision: int) -> dict[str, bytes]:
        return await self._registry.files(revision)


def _read(path: Path) -> RecordedMission:
    return recorded(rows_of(path))
