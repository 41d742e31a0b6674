"""The supervisor with small real services on a real bus: order, ends, and what stays behind."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from processes import HANG_S, descendants, has_listener, is_running, kill, until_ended

from aos_deploy.endpoint import hold_endpoint
from aos_deploy.events import Event, ServiceChanged
from aos_deploy.program import Program
from aos_deploy.run_directory import RunDirectory
from aos_deploy.supervisor import Supervisor, supervised
from aos_protocol.errors import AosError, DeployError, DocumentError
from aos_runtime.clock import SystemClock
from aos_runtime.lifecycle import root_cause
from aos_runtime.service_settings import ServiceSettings

NAMES = ("registry", "middleware", "skills", "solver")
TESTS = Path(__file__).parents[1]


def small(name: str, mood: str = "good", *, start_s: float = 20.0, stop_s: float = 5.0) -> Program:
    return Program(name=name, module="small_service", settings={"mood": mood}, start_s=start_s, stop_s=stop_s)


def command(*words: str, restarts: int = 0) -> Program:
    """An adapter `robot` that is a program of the user's own."""
    return Program(
        name="robot",
        command=words,
        folder=str(TESTS),
        paths=("/sense",),
        restarts=restarts,
        is_adapter=True,
    )


class System:
    """A supervised system of small services in its own run directory."""

    def __init__(self, folder: Path) -> None:
        self.run = RunDirectory.create(folder / "runs", "test", 0)
        with hold_endpoint("tcp/127.0.0.1:0") as endpoint:
            self.endpoint = endpoint
        self.events: list[ServiceChanged] = []
        self.pids: list[int] = []
        self._news = asyncio.Event()

    @property
    def port(self) -> int:
        return int(self.endpoint.rpartition(":")[2])

    @asynccontextmanager
    async def up(self, *programs: Program) -> AsyncIterator[Supervisor]:
        base = ServiceSettings(robot="test", service="", endpoint=self.endpoint, run_dir=str(self.run.path))
        try:
            async with supervised(programs, base, self.run, self._note, SystemClock()) as supervisor:
                await supervisor.start()
                yield supervisor
        except BaseExceptionGroup as group:
            raise root_cause(group) from group

    async def error(self, *programs: Program, victim: str = "") -> AosError:
        """What a system of these programs fails with, after the victim is killed if there is one."""
        try:
            async with self.up(*programs) as supervisor:
                await supervisor.until_ready()
                self.pids = list(supervisor.pids.values())
                if victim:
                    kill(supervisor.pids[victim])
                await asyncio.Event().wait()
        except AosError as error:
            return error
        pytest.fail("the system did not fail")

    def order(self, state: str) -> list[str]:
        """The services that came into a state, in this order."""
        return [event.service for event in self.events if event.state == state]

    async def until(self, service: str, state: str, times: int = 1) -> None:
        """Returns when a service has come into a state so many times."""
        while sum((each.service, each.state) == (service, state) for each in self.events) < times:
            self._news.clear()
            await self._news.wait()

    def _note(self, event: Event) -> None:
        assert isinstance(event, ServiceChanged)
        self.events.append(event)
        self._news.set()


@pytest.fixture
def system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> System:
    monkeypatch.setenv("PYTHONPATH", str(TESTS))
    return System(tmp_path)


@pytest.fixture
def programs() -> Callable[..., tuple[Program, ...]]:
    """The four services, good but for those whose mood is given."""

    def make(**moods: str) -> tuple[Program, ...]:
        return tuple(small(name, moods.get(name, "good")) for name in NAMES)

    return make


async def test_services_start_get_ready_and_stop_in_reverse_order(
    system: System, programs: Callable[..., tuple[Program, ...]]
) -> None:
    async with system.up(*programs()) as supervisor:
        await supervisor.until_ready()
        pids = list(supervisor.pids.values())
        assert all(is_running(pid) for pid in pids)

    assert system.order("starting") == ["router", *NAMES]
    assert system.order("ready")[0] == "router"
    assert sorted(system.order("ready")[1:]) == sorted(NAMES)
    assert system.order("stopping") == [*reversed(NAMES), "router"]
    assert (system.run.path / "stopped").read_text().split() == list(reversed(NAMES))
    assert not any(is_running(pid) for pid in pids)
    assert not has_listener(system.port)


async def test_one_service_can_be_waited_for_before_the_others(system: System) -> None:
    async with system.up(small("registry"), small("skills", "slow")) as supervisor:
        await supervisor.until_ready("registry")
        assert "skills" not in system.order("ready")


async def test_a_service_that_is_not_ready_in_time_is_named_with_its_log(system: System) -> None:
    error = await system.error(small("registry"), small("skills", "slow", start_s=1.5))
    assert isinstance(error, DeployError)
    assert error.code == "AOS802"
    assert error.message == "skills was not ready within 1.5 s"
    assert "still thinking" in error.hint
    assert str(system.run.log("skills")) in error.hint


async def test_a_fault_at_the_start_comes_out_whole(system: System) -> None:
    error = await system.error(small("registry"), small("skills", "faulty"))
    assert isinstance(error, DocumentError)
    assert str(error) == "AOS102: skills: the world is wrong. Mend it"
    assert str(error.diagnostics[0].span) == "room.yaml:3:1"


async def test_a_defect_in_a_service_is_told_in_one_line(system: System) -> None:
    error = await system.error(small("registry"), small("skills", "broken"))
    assert str(error) == "AOS606: skills: skills ended by a defect: RuntimeError: a defect"
    assert "Traceback" in system.run.log("skills").read_text()


async def test_a_program_that_cannot_run_is_told(system: System) -> None:
    error = await system.error(Program(name="skills", module="no_such_package"))
    assert error.code == "AOS802"
    assert "skills ended unexpectedly: exit status 1" in error.message
    assert "No module named no_such_package" in error.hint


@pytest.mark.parametrize("victim", ["router", *NAMES])
async def test_the_death_of_any_process_ends_the_system(
    system: System, programs: Callable[..., tuple[Program, ...]], victim: str
) -> None:
    error = await system.error(*programs(), victim=victim)
    assert error.message == f"{victim} ended unexpectedly: killed by SIGKILL"
    assert error.code == "AOS804"
    assert not any(is_running(pid) for pid in system.pids)


async def test_a_service_that_ignores_sigterm_is_killed(system: System) -> None:
    async with system.up(small("skills", "deaf", stop_s=0.2)) as supervisor:
        await supervisor.until_ready()
        pid = supervisor.pids["skills"]
    assert not is_running(pid)


async def test_cancelling_stops_everything_and_its_children(system: System) -> None:
    up = asyncio.Event()
    pids: list[int] = []

    async def work() -> None:
        async with system.up(small("registry"), small("solver", "parental")) as supervisor:
            await supervisor.until_ready()
            for pid in supervisor.pids.values():
                pids.extend([pid, *descendants(pid)])
            up.set()
            await asyncio.Event().wait()

    task = asyncio.create_task(work())
    await up.wait()
    assert len(pids) == 6
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    await until_ended(pids)


async def test_a_killed_system_leaves_no_grandchildren(system: System) -> None:
    pids: list[int] = []
    async with system.up(small("solver", "parental")) as supervisor:
        await supervisor.until_ready()
        for pid in supervisor.pids.values():
            pids.extend([pid, *descendants(pid)])
        supervisor.kill()
    await until_ended(pids)


@pytest.mark.parametrize("name", [(), ("a_name_of_its_own",)], ids=["told", "own"])
async def test_a_command_starts_when_the_router_listens_and_is_ready_when_it_serves(
    system: System, name: tuple[str, ...]
) -> None:
    async with (
        asyncio.timeout(HANG_S),
        system.up(small("registry"), command("python", "small_command.py", *name)),
    ):
        await system.until("robot", "ready")
    changes = [(each.service, each.state) for each in system.events]
    assert changes.index(("router", "ready")) < changes.index(("robot", "starting"))
    assert system.order("starting").count("robot") == 1


async def test_a_command_that_starts_again_is_ready_again(system: System) -> None:
    async with (
        asyncio.timeout(HANG_S),
        system.up(command("python", "small_command.py", restarts=1)) as supervisor,
    ):
        await system.until("robot", "ready")
        kill(supervisor.pids["robot"])
        await system.until("robot", "ready", times=2)
    states = [each.state for each in system.events if each.service == "robot"]
    assert states[:5] == ["starting", "ready", "ended", "starting", "ready"]


async def test_a_command_that_ends_before_it_serves_is_tried_again(system: System) -> None:
    error = await system.error(command("sh", "-c", "echo no camera; exit 4", restarts=1))
    assert system.order("ended") == ["robot", "robot", "router"]
    assert error.code == "AOS802"
    assert error.message == "robot ended unexpectedly: exit status 4"
    assert "no camera" in error.hint


async def test_a_command_that_cannot_be_started_is_not_tried_again(system: System) -> None:
    error = await system.error(command("./no_such_program", restarts=3))
    assert system.order("ended") == ["robot", "router"]
    assert error.code == "AOS802"
    assert "cannot start ./no_such_program: No such file or directory" in error.hint
