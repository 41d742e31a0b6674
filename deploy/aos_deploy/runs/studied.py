"""A run on disk as a mission that can be replayed and studied: its journal, documents, settings, policy."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import TypeVar

import msgspec
from msgspec.structs import replace

from aos_deploy.places import cache_dir
from aos_deploy.runs.directory import RunDirectory
from aos_language.load import load_files
from aos_protocol.codec import UNREADABLE
from aos_protocol.documents import Project
from aos_protocol.errors import StorageError, StudyError
from aos_registry.catalogue import Catalogue
from aos_runtime.disk.journal import rows_of
from aos_runtime.disk.mission_folders import JOURNAL, mission_folder, mission_folders
from aos_solver.settings import Settings
from aos_solver.study.recorded import RecordedMission, recorded
from aos_solver.study.replaying import ReplayedMission
from aos_solver.study.study import Study

T = TypeVar("T")


def no_such_mission(run: Path, number: int) -> StudyError:
    """The error where a run has no mission of that number."""
    missions = len(mission_folders(run))
    hint = f"It has {missions} missions" if missions else "It has one mission: leave --mission out"
    return StudyError(f"{run.resolve().name} has no mission {number}", hint=hint)


class StudiedRun:
    """One mission of a run directory, which may still run: what its journal has now counts."""

    def __init__(self, run: Path, mission: RecordedMission, settings: Settings) -> None:
        self.run = run
        self.mission = mission
        self.settings = settings
        self.documents = _Catalogued(run / "catalogue.db", settings.project)

    @classmethod
    def open(cls, run: Path, number: int | None = None) -> StudiedRun:
        """The mission of that number in a system that stays, by default the last one.

        StudyError AOS530 if there is none, StorageError AOS702 if its journal or settings cannot be read.
        """
        folders = mission_folders(run)
        if folders and number is None:
            number = max(folders)
        if number is not None and number not in folders:
            raise no_such_mission(run, number)
        return cls.of_journal(run, str((mission_folder(run, number or 0) / JOURNAL).relative_to(run)))

    @classmethod
    def of_journal(cls, run: Path, file: str) -> StudiedRun:
        """The mission of a journal, by its path below the run; errors as from `open`."""
        try:
            text = (run / "settings" / "solver.json").read_bytes()
            settings = msgspec.json.decode(text, type=Settings)
        except (OSError, *UNREADABLE) as error:
            raise StorageError(
                f"the settings of the solver in {run} cannot be read: {error}", code="AOS702"
            ) from error
        mission = recorded(rows_of(run / file))
        return cls(run, mission, replace(settings, cache_dir=str(cache_dir())))

    async def study(self, ask: Callable[[Study], Awaitable[T]]) -> T:
        """The answer to one question about the mission."""
        async with Study(_Read(self), cache_dir()) as study:
            return await ask(study)

    def replay(self, on_progress: Callable[[str], None], *, decides: bool = False) -> ReplayedMission:
        """A replay of the mission, which has begun; StudyError AOS530 if it has not.

        Somebody waits for it: on a full machine the lowest priority would make minutes of a second.
        """
        if self.mission.begun is None:
            raise StudyError(f"the mission of {self.run.name} has not begun", hint="Wait until it has")
        policy = RunDirectory(self.run).policy
        return ReplayedMission(
            self.mission,
            self.documents,
            self.settings,
            on_progress=on_progress,
            decides=decides,
            policy=policy if policy.exists() else None,
            niceness=0,
        )


class _Read:
    def __init__(self, studied: StudiedRun) -> None:
        self._studied = studied

    async def recorded(self, mission: str) -> RecordedMission:
        """The mission, which is the only one here."""
        return self._studied.mission

    def replay(self, mission: RecordedMission) -> ReplayedMission:
        return self._studied.replay(lambda text: None)

    async def files(self, revision: int) -> dict[str, bytes]:
        return await self._studied.documents.files(revision)


class _Catalogued:
    """The documents in a run's catalogue."""

    def __init__(self, path: Path, project: str) -> None:
        self._path = path
        self._project = project

    async def revision(self, number: int) -> Project:
        """The documents of a revision; StorageError AOS702 if they are gone."""
        project = load_files(await self.files(number), name=self._project).project
        if project is None:
            raise StorageError(f"revision {number} of {self._project} has errors here", code="AOS702")
        return project

    async def files(self, number: int) -> dict[str, bytes]:
        """The files of a revision; StorageError AOS702 if they are gone."""
        if not self._path.exists():
            raise StorageError("the run has no catalogue of its documents", code="AOS702")
        catalogue = Catalogue.open(self._path)
        try:
            revision = catalogue.revision(self._project, number)
        finally:
            catalogue.close()
        if revision is None:
            raise StorageError(f"the catalogue has no revision {number} of {self._project}", code="AOS702")
        return revision.files
