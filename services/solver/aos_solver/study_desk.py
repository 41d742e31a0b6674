"""The solver's answers to studies of its missions, by an engine that no mission asks."""

import asyncio
from pathlib import Path

from aos_protocol.documents import Project
from aos_protocol.keys import Keys
from aos_protocol.messages import DecisionTree, TreeQuery, WhatIf, WhatIfQuery, Why, WhyQuery
from aos_runtime.bus.bus import Bus
from aos_runtime.disk.journal import rows_of
from aos_runtime.parties.registry_watch import RegistryWatch
from aos_solver.mission.records.logbook import Logbooks
from aos_solver.settings import Settings
from aos_solver.study.recorded import RecordedMission, recorded
from aos_solver.study.replaying import NICENESS, ReplayedMission
from aos_solver.study.study import Study

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
