import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from aos_deploy.events import Event, ServiceChanged
from aos_deploy.processes.endpoint import hold_endpoint
from aos_deploy.processes.program import Program
from aos_deploy.processes.supervisor import Supervisor, supervised
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import ProcessEnd
from aos_protocol.errors import AosError
from aos_runtime.clock import SystemClock
from aos_runtime.processes.lifecycle import root_cause
from aos_runtime.processes.settings import ServiceSettings

TESTS = Path(__file__).parent


def small(
    name: str,
    mood: str = "good",
    *,
    start_s: float = 20.0,
    stop_s: float = 5.0,
    is_adapter: bool = False,
    is_restarted: bool = False,
) -> Program:
    """A service that behaves as its mood says; see `small_service`."""
    return Program(
        name=name,
        module="small_service",
        settings={"mood": mood},
        start_s=start_s,
        stop_s=stop_s,
        is_adapter=is_adapter,
        is_restarted=is_restarted,
    )


def command(*words: str, is_restarted: bool = False) -> Program:
    return Program(
        name="robot",
        command=words,
        folder=str(TESTS),
        paths=("/sense",),
        is_restarted=is_restarted,
        is_adapter=True,
    )


class System:
    """A supervised system of small services in its own run directory."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.run = RunDirectory.create(folder / "runs", "test", 0)
        with hold_endpoint("tcp/127.0.0.1:0") as endpoint:
            self.endpoint = endpoint
        self.events: list[ServiceChanged] = []
        self.ends: list[ProcessEnd] = []
        self._news = asyncio.Event()

    @property
    def port(self) -> int:
        return int(self.endpoint.rpartition(":")[2])

    @asynccontextmanager
    async def up(self, *programs: Program) -> AsyncIterator[Supervisor]:
        base = ServiceSettings(robot="test", service="", endpoint=self.endpoint, run_dir=str(self.run.path))
        try:
            async with supervised(programs, base, self.run, self._note, SystemClock()) as supervisor:
                self.ends = supervisor.ends
                await supervisor.start()
                yield supervisor
        except BaseExceptionGroup as group:
            raise root_cause(group) from group

    async def error(self, *programs: Program) -> AosError:
        try:
            async with self.up(*programs) as supervisor:
                await supervisor.until_ready()
                await asyncio.Event().wait()
        except AosError as error:
            return error
        pytest.fail("the system did not fail")

    def order(self, state: str) -> list[str]:
        return [event.service for event in self.events if event.state == state]

    async def until(self, service: str, state: str, times: int = 1) -> None:
        while sum((event.service, event.state) == (service, state) for event in self.events) < times:
            self._news.clear()
            await self._news.wait()

    def _note(self, event: Event) -> None:
        assert isinstance(event, ServiceChanged)
        self.events.append(event)
        self._news.set()
