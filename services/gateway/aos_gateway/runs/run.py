"""A run: one on this machine, living or past, or a system at an endpoint."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from pathlib import Path

import msgspec

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.end import ending_without_summary, message_of_row
from aos_deploy.runs.record import RunRecord, Summary
from aos_protocol.access import WATCHER
from aos_protocol.errors import AosError, GatewayError
from aos_protocol.messages import History, HistoryQuery, MissionBegun, MissionEntry, MissionState
from aos_protocol.mission_rows import BEGUN, STATE
from aos_runtime.client import AosClient
from aos_runtime.disk.journal import Journal, JournalRow
from aos_runtime.disk.mission_folders import (
    JOURNAL,
    mission_folder,
    mission_folders,
    mission_name,
    number_in,
    stays,
)
from aos_solver.mission.records.history import history_page
from aos_solver.mission.records.logbook import entries_of

_BEGINNING_S = 1.0
_END_S = 60.0
"""An ordered end takes less."""
_LOOK_S = 0.5
"""Somebody who waits for an answer hears so soon that the system has ended."""


class RunEntry(msgspec.Struct, frozen=True, omit_defaults=True):
    """One run: a start of a system. `ending` is `running` while it goes on, `waiting` between missions,
    `killed` or `not_started` if nobody ended it.

    `missions` are the names of its missions, the oldest first. Of a system at an endpoint `directory` is
    empty.
    """

    run: str
    robot: str
    is_running: bool
    ending: str
    started: str = ""
    deploy_file: str = ""
    directory: str = ""
    endpoint: str = ""
    seed: int = 0
    is_played: bool = False
    sandbox: str = ""
    stays: bool = False
    missions: tuple[str, ...] = ()


class Run(ABC):
    """A run, on this machine or elsewhere."""

    name: str
    robot: str
    endpoint: str

    @property
    @abstractmethod
    def is_running(self) -> bool:
        """True while its system is there."""

    @abstractmethod
    async def entry(self) -> RunEntry:
        """The run in the list."""

    @abstractmethod
    async def missions(self) -> tuple[MissionEntry, ...]:
        """Its missions, the oldest first."""

    @abstractmethod
    async def page(self, mission: str, since: int, limit: int = 0) -> History:
        """The decision records of a mission from a sequence number on."""

    @abstractmethod
    async def last_state(self, mission: str) -> MissionState | None:
        """The last that is known of a mission; None before its first word, and of one that is not the
        newest of a system elsewhere."""

    async def beginning(self, mission: str) -> MissionState:
        """The state of a mission of a system that runs, which has no record of it yet."""
        with suppress(AosError, TimeoutError):  # Its services may start only now.
            async with asyncio.timeout(_BEGINNING_S), self.client() as client:
                state = await client.mission_state()
                if state.mission == mission:
                    return state
        return MissionState(mission, "waiting", 0, 0.0)

    async def end(self) -> None:
        """Ends its system in order, and waits until it is over; GatewayError AOS905 if it does not run."""
        raise GatewayError(f"the system {self.name} runs elsewhere", code="AOS905", hint="End it there")

    async def parameters(self, mission: str) -> dict[str, str]:
        """The values of a mission's parameters; none where they are not known."""
        return {}

    def client(self, user: str = WATCHER) -> AbstractAsyncContextManager[AosClient]:
        """A client of the system, as its watcher or its operator; GatewayError AOS905 if it does not run."""
        if not self.is_running:
            raise self._over()
        return self._client(user)

    @asynccontextmanager
    async def asking(self, user: str = WATCHER) -> AsyncIterator[AosClient]:
        """A client for a question: GatewayError AOS905 also if the system ends before it answers.

        Its bus does not tell that: nobody answers a question there, and it is asked again until its deadline.
        """
        try:
            async with asyncio.timeout(None) as until_over:
                looking = asyncio.create_task(self._look(until_over))
                try:
                    async with self.client(user) as client:
                        yield client
                finally:
                    looking.cancel()
        except TimeoutError:
            if until_over.expired():
                raise self._over() from None
            raise

    async def _look(self, until_over: asyncio.Timeout) -> None:
        await _until_not(lambda: self.is_running)
        until_over.reschedule(asyncio.get_running_loop().time())

    def _over(self) -> GatewayError:
        return GatewayError(
            f"the run {self.name} is over", code="AOS905", hint="Start a system, or look at its records"
        )

    @abstractmethod
    def _client(self, user: str) -> AbstractAsyncContextManager[AosClient]:
        """The same of a system that runs."""


class KeptRun(Run):
    def __init__(self, directory: RunDirectory, record: RunRecord) -> None:
        self.directory = directory
        self.record = record
        self.name = directory.path.name
        self.robot = record.robot
        self.endpoint = record.endpoint
        self._last: RunEntry | None = None
        self._has_summary = False

    @property
    def is_running(self) -> bool:
        return self.directory.is_running

    async def entry(self) -> RunEntry:
        if self._last is None or self._last.is_running or self._goes_on_again():
            self._last = await asyncio.to_thread(self._entry)
        return self._last

    async def end(self) -> None:
        if not await asyncio.to_thread(self._interrupt):
            raise self._over()
        try:
            async with asyncio.timeout(_END_S):
                await _until_not(lambda: self.directory.is_held)
        except TimeoutError:
            raise GatewayError(f"{self.name} was asked to end, and has not yet", code="AOS601") from None

    def _interrupt(self) -> bool:
        return self.is_running and self.directory.interrupt(self.record.pid)

    def _goes_on_again(self) -> bool:
        """Says whether a run whose aos-up was killed was taken up, and may be over again."""
        if self._last is None or self._has_summary:
            return False
        return self.directory.is_held or self.directory.read_summary() is not None

    def _ending_without_summary(self, newest: int, is_running: bool) -> str:
        if not is_running:
            return ending_without_summary(self.directory.path)
        return "waiting" if stays(self.directory.path) and self.directory.read_summary(newest) else "running"

    def _entry(self) -> RunEntry:
        path, record = self.directory.path, self.record
        numbers = list(mission_folders(path)) or [1]  # The first one has no folder before it begins.
        names = tuple(mission_name(path, number) for number in numbers) if stays(path) else (path.name,)
        summary = self.directory.read_summary()
        self._has_summary = summary is not None
        is_running = summary is None and self.is_running
        return RunEntry(
            run=self.name,
            robot=record.robot,
            is_running=is_running,
            ending=summary.ending if summary else self._ending_without_summary(numbers[-1], is_running),
            started=record.started,
            deploy_file=record.deploy_file,
            directory=str(path),
            endpoint=record.endpoint,
            seed=record.seed,
            is_played=record.is_played,
            sandbox=record.sandbox,
            stays=stays(path),
            missions=names,
        )

    def _client(self, user: str) -> AbstractAsyncContextManager[AosClient]:
        return AosClient.of_run(self.directory.path, user)

    async def missions(self) -> tuple[MissionEntry, ...]:
        return await asyncio.to_thread(entries_of, self.directory.path)

    async def page(self, mission: str, since: int, limit: int = 0) -> History:
        journal = self.folder(mission) / JOURNAL
        if not journal.exists():
            return History(mission, ())
        return await asyncio.to_thread(history_page, journal, mission, HistoryQuery(since, limit))

    async def last_state(self, mission: str) -> MissionState | None:
        last = await asyncio.to_thread(self._last_row, mission, STATE)
        state = message_of_row(last) if last is not None else None
        if isinstance(state, MissionState):
            return state
        if (end := self.summary(mission)) is None:
            return None
        # It ended before it began.
        return MissionState(mission, "ended", end.steps, 0.0, ending=end.ending, remark=end.remark)

    async def parameters(self, mission: str) -> dict[str, str]:
        last = await asyncio.to_thread(self._last_row, mission, BEGUN)
        return {} if last is None else last.read_as(MissionBegun).mission_parameters

    def _last_row(self, mission: str, kind: str) -> JournalRow | None:
        journal = self.folder(mission) / JOURNAL
        if not journal.exists():
            return None
        with Journal.read(journal) as rows:
            return next(iter(rows.rows(kind)[-1:]), None)

    def folder(self, mission: str) -> Path:
        """The folder of a mission's journal and summary."""
        number = number_in(self.name, mission)
        return self.directory.path if number is None else mission_folder(self.directory.path, number)

    def summary(self, mission: str) -> Summary | None:
        """The summary of a mission that has ended; that of its run where it has not begun."""
        number = number_in(self.name, mission) or 0
        return self.directory.read_summary(number if number in mission_folders(self.directory.path) else 0)


class RemoteRun(Run):
    """A system at an endpoint, of which nothing but its bus is known.

    Its name has the robot and the whole place, since files of one name lie in many folders. The gateway is
    there who AOS_USER and AOS_PASSWORD_FILE say.
    """

    is_running = True

    def __init__(self, endpoint: str, robot: str) -> None:
        self.endpoint = endpoint
        self.robot = robot
        place = endpoint.partition("/")[2].strip("/").replace("/", "_")
        self.name = f"{robot}@{place}"

    async def entry(self) -> RunEntry:
        try:
            missions = await self.missions()
        except AosError:
            return RunEntry(
                self.name, self.robot, is_running=False, ending="unreachable", endpoint=self.endpoint
            )
        names = tuple(mission.mission for mission in missions)
        return RunEntry(
            self.name, self.robot, is_running=True, ending="running", endpoint=self.endpoint, missions=names
        )

    def _client(self, user: str) -> AbstractAsyncContextManager[AosClient]:
        return AosClient.connect(self.endpoint, self.robot)

    async def missions(self) -> tuple[MissionEntry, ...]:
        async with self.client() as client:
            return (await client.missions()).entries

    async def page(self, mission: str, since: int, limit: int = 0) -> History:
        async with self.client() as client:
            return await client.page(HistoryQuery(since, limit, mission))

    async def last_state(self, mission: str) -> MissionState | None:
        async with self.client() as client:
            state = await client.mission_state()
        return state if state.mission == mission else None


async def _until_not(holds: Callable[[], bool]) -> None:
    """Looks at files, which tell nobody that they change."""
    does_hold = True
    while does_hold:
        await asyncio.sleep(_LOOK_S)
        does_hold = await asyncio.to_thread(holds)
