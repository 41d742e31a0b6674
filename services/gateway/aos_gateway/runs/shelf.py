"""The runs that the gateway knows, by the names of runs and of missions."""

import asyncio
import threading
import time
from collections.abc import Iterable
from pathlib import Path

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import living_runs
from aos_gateway.runs.run import KeptRun, RemoteRun, Run, RunEntry
from aos_protocol.errors import DeployError, GatewayError
from aos_runtime.disk.mission_folders import number_of

LATEST = "latest"
_FRESH_S = 0.8


class RunShelf:
    """All runs by name. Folders in which a living run was found stay in view."""

    def __init__(
        self, folders: Iterable[Path], remote: Iterable[RemoteRun] = (), directories: Iterable[Path] = ()
    ) -> None:
        """The runs in the folders, those at endpoints, and those of single run directories."""
        self._folders = {folder.resolve(): None for folder in folders}
        self._remote = {run.name: run for run in remote}
        self._directories = frozenset(path.resolve() for path in directories)
        self._kept: dict[Path, KeptRun] = {}
        self._entries: tuple[RunEntry, ...] = ()
        self._looked_s = -_FRESH_S
        self._looking = asyncio.Lock()
        self._reading = threading.Lock()  # Lists are also made in a thread.

    async def entries(self) -> tuple[RunEntry, ...]:
        """The list of runs, the newest first, as it was less than a second ago: viewers share a look."""
        async with self._looking:
            if time.monotonic() - self._looked_s >= _FRESH_S:
                runs = await asyncio.to_thread(self.runs)
                self._entries = tuple([await run.entry() for run in runs.values()])
                self._looked_s = time.monotonic()
            return self._entries

    def runs(self) -> dict[str, Run]:
        """The runs, the newest first. Of two directories of one name the last by path is shown."""
        with self._reading:
            return self._read()

    def _read(self) -> dict[str, Run]:
        living = {run.path for run in living_runs()}
        self._folders |= {path.parent: None for path in living}
        paths = living | self._directories
        for folder in self._folders:
            paths |= {record.parent for record in folder.glob("*/run.json") if not record.parent.is_symlink()}
        for gone in self._kept.keys() - paths:
            del self._kept[gone]
        for path in paths - self._kept.keys():
            try:
                self._kept[path] = KeptRun(RunDirectory(path), RunDirectory(path).read_record())
            except DeployError:
                continue
        newest_first = sorted(self._kept, key=lambda path: (path.name, str(path)), reverse=True)
        runs: dict[str, Run] = dict(self._remote)
        for path in newest_first:
            runs.setdefault(path.name, self._kept[path])
        return runs

    def run(self, name: str) -> Run:
        """The run of this name, of `latest` this machine's newest; GatewayError AOS902 if there is none."""
        runs = self.runs()
        if name == LATEST:
            name = next((one for one in runs if one not in self._remote), name)
        found = runs.get(name)
        if found is None:
            raise GatewayError(f"there is no run {name}", hint="GET /v1/runs lists them")
        return found

    async def named(self, mission: str) -> str:
        """The mission's name: of `latest` that of the newest; GatewayError AOS902 where there is none."""
        if mission != LATEST:
            return mission
        names = [entry.missions[-1] for entry in await self.entries() if entry.missions]
        if not names:
            raise GatewayError("there is no mission yet", hint="POST /v1/runs starts one")
        return max(names)  # They begin with the time in UTC.

    async def run_of_mission(self, mission: str) -> Run:
        """The run of a mission; GatewayError AOS902 if there is none."""
        runs = self.runs()
        place = number_of(mission)
        found = runs.get(mission) or (runs.get(place[0]) if place is not None else None)
        if found is not None:
            return found
        for run in self._remote.values():
            if any(entry.mission == mission for entry in await run.missions()):
                return run
        raise GatewayError(f"there is no mission {mission}", hint="GET /v1/missions lists them")
