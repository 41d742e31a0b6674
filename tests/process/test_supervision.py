import asyncio
import os
import re
import signal
import sys
from collections.abc import Callable

import msgspec
import pytest
from processes import HANG_S, descendants, has_listener, is_running, kill, until_ended
from ssh_host import stand_in
from supervised_system import System, command, small

from aos_deploy.processes import silences as silences_module
from aos_deploy.processes.consequence import STARTS
from aos_deploy.processes.program import Program
from aos_deploy.processes.silences import FROZEN_S
from aos_protocol.errors import AosError, DeployError, DocumentError

NAMES = ("registry", "middleware", "skills", "solver")
DEATHS = pytest.mark.parametrize("death", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])


@pytest.fixture
def programs() -> Callable[..., tuple[Program, ...]]:
    """The four services, good but for those whose mood is given."""

    def make(**moods: str) -> tuple[Program, ...]:
        return tuple(small(name, moods.get(name, "good")) for name in NAMES)

    return make


async def test_services_start_get_ready_and_stop_in_reverse_order(
    system: System, programs: Callable[..., tuple[Program, ...]]
):
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


async def test_one_service_can_be_waited_for_before_the_others(system: System):
    async with system.up(small("registry"), small("skills", "slow")) as supervisor:
        await supervisor.until_ready("registry")
        assert "skills" not in system.order("ready")


async def test_a_service_that_is_not_ready_in_time_is_named_with_its_log(system: System):
    error = await system.error(small("registry"), small("skills", "slow", start_s=5))
    assert isinstance(error, DeployError)
    assert error.code == "AOS802"
    assert error.message == "skills was not ready within 5 s"
    assert "still thinking" in error.hint
    assert str(system.run.log("skills")) in error.hint


async def test_a_fault_at_the_start_comes_out_whole(system: System):
    error = await system.error(small("registry"), small("skills", "faulty"))
    assert isinstance(error, DocumentError)
    assert str(error) == "AOS102: skills: the world is wrong. Mend it"
    assert str(error.diagnostics[0].span) == "room.yaml:3:1"
    assert "AOS102: the world is wrong. Mend it" in system.run.log("skills").read_text()


async def test_a_defect_in_a_service_is_told_in_one_line(system: System):
    error = await system.error(small("registry"), small("skills", "broken"))
    assert error.code == "AOS606"
    assert error.message == "skills: ended by a defect: RuntimeError: a defect"
    assert re.search(r"It was raised in \S+small_service\.py:\d+; the log has all of it", error.hint)
    assert "Traceback" in system.run.log("skills").read_text()


async def test_a_service_on_a_full_disk_is_told_as_that_though_its_fault_has_no_space(system: System):
    error = await system.error(small("registry"), small("skills", "full"))
    assert str(error).startswith("AOS701: skills could not write or read its files. See that the disk of the")
    assert "database or disk is full" in error.hint


async def test_a_program_that_cannot_run_is_told(system: System):
    error = await system.error(Program(name="skills", module="no_such_package"))
    assert error.code == "AOS802"
    assert "skills ended unexpectedly: exit status 1" in error.message
    assert "No module named no_such_package" in error.hint


async def test_a_router_that_dies_is_started_again_and_all_find_back_to_it(system: System):
    async with asyncio.timeout(HANG_S), system.up(small("solver", is_restarted=True)) as supervisor:
        await supervisor.until_ready()
        pid = supervisor.pids["solver"]
        kill(supervisor.pids["router"])
        await system.until("router", "ready", times=2)
        await system.until("solver", "ready", times=2)
        assert supervisor.pids["solver"] == pid, "the service was not started again"


async def test_a_frozen_router_is_killed_and_those_behind_it_are_not(system: System):
    services = (small("solver", is_restarted=True), small("registry", is_restarted=True))
    robot = command("python", "small_command.py", is_restarted=True)
    async with asyncio.timeout(HANG_S), system.up(robot, *services) as supervisor:
        await supervisor.until_ready()
        await system.until("robot", "ready")
        before = supervisor.pids
        os.kill(before["router"], signal.SIGSTOP)
        await system.until("router", "frozen")
        for name in ("router", "solver", "registry"):
            await system.until(name, "ready", times=2)
        assert not system.order("silent"), "a program was blamed for its router"
        assert [end.name for end in system.ends] == ["router"]
        assert {name for name, pid in supervisor.pids.items() if before[name] != pid} == {"router"}


async def test_a_service_that_ends_again_and_again_ends_the_system_with_the_count(system: System):
    async def work():
        async with asyncio.timeout(HANG_S), system.up(small("solver", is_restarted=True)) as supervisor:
            await supervisor.until_ready()
            for times in range(1, STARTS + 1):
                await system.until("solver", "ready", times=times)
                kill(supervisor.pids["solver"])
            await asyncio.Event().wait()

    with pytest.raises(AosError, match="killed by SIGKILL, and was started 5 times within 60 s") as raised:
        await work()
    assert raised.value.code == "AOS804"


async def test_cancelling_stops_everything_and_its_children(system: System):
    up = asyncio.Event()
    pids: list[int] = []

    async def work():
        async with system.up(small("registry"), small("solver", "parental")) as supervisor:
            await supervisor.until_ready()
            for pid in supervisor.pids.values():
                pids.extend([pid, *descendants(pid)])
            up.set()
            await asyncio.Event().wait()

    task = asyncio.create_task(work())
    await up.wait()
    assert len(pids) == 7  # the keeper of its guard is one of them
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    await until_ended(pids)


@DEATHS
async def test_a_command_that_starts_again_is_ready_again(system: System, death: signal.Signals):
    async with (
        asyncio.timeout(HANG_S),
        system.up(command("python", "small_command.py", is_restarted=True)) as supervisor,
    ):
        await system.until("robot", "ready")
        guard = supervisor.pids["robot"]
        victims = descendants(guard)
        # A whole group may be frozen, with the guard that is to end it.
        for pid in (guard, *victims) if death == signal.SIGSTOP else victims[-1:]:
            os.kill(pid, death)
        await system.until("robot", "ready", times=2)
        await until_ended(victims)
    states = [event.state for event in system.events if event.service == "robot" and event.state != "frozen"]
    assert states[:5] == ["starting", "ready", "ended", "starting", "ready"]
    assert [end.how for end in system.ends] == ["killed by SIGKILL"]


async def test_a_frozen_command_on_another_host_starts_again_and_its_silence_is_told(
    system: System, tmp_path, monkeypatch
):
    monkeypatch.setenv("PATH", stand_in(tmp_path) + os.pathsep + os.environ["PATH"])
    script = f"echo $$ > {tmp_path}/pid; exec {sys.executable} small_command.py"
    program = msgspec.structs.replace(command("sh", "-c", script, is_restarted=True), host="robot@arm")
    async with asyncio.timeout(HANG_S), system.up(program):
        await system.until("robot", "ready")
        os.kill(int((tmp_path / "pid").read_text()), signal.SIGSTOP)
        await system.until("robot", "ready", times=2)
    (frozen,) = (event.detail for event in system.events if event.state == "frozen")
    silence = re.fullmatch(r"off the bus for ([\d.]+) s; it is killed", frozen)
    assert silence is not None
    assert float(silence[1]) >= FROZEN_S
    assert [end.how for end in system.ends] == ["killed by SIGKILL"]


async def test_a_command_that_runs_and_serves_nothing_is_told_and_can_be_ended(system: System, monkeypatch):
    monkeypatch.setattr(silences_module, "FROZEN_S", 0.1)
    async with (
        asyncio.timeout(HANG_S),
        system.up(command("python", "small_command.py", is_restarted=True)) as supervisor,
    ):
        await system.until("robot", "ready")
        os.kill(descendants(supervisor.pids["robot"])[-1], signal.SIGUSR1)
        await system.until("robot", "silent")
        (told,) = (event.detail for event in system.events if event.state == "silent")
        (pid,) = re.findall(r"has served nothing .* kill (\d+) ends it", told)
        os.kill(int(pid), signal.SIGTERM)
        await system.until("robot", "ready", times=2)


async def test_a_service_that_does_not_end_is_told_before_it_is_killed(system: System):
    async with system.up(small("skills", "deaf", stop_s=2)) as supervisor:
        await supervisor.until_ready()
    told = [event.detail for event in system.events if event.state == "stopping" and event.detail]
    assert told == ["it has not ended yet; 2 s after it was asked to, it is killed"]


async def test_an_adapter_that_ends_itself_and_starts_again_says_why(system: System):
    async with system.up(small("robot", "stuck", is_adapter=True, is_restarted=True)) as supervisor:
        await supervisor.until_ready()
        os.kill(descendants(supervisor.pids["robot"])[-1], signal.SIGUSR1)
        await system.until("robot", "ended")
    (told, *_) = [event.detail for event in system.events if event.state == "ended" and event.detail]
    assert told == "exit status 1, the arm is stuck; it is started again"


async def test_a_command_that_ends_before_it_serves_is_tried_again(system: System):
    error = await system.error(command("sh", "-c", "echo no camera; exit 4", is_restarted=True))
    assert system.order("ended") == ["robot"] * 5 + ["router"]
    assert error.code == "AOS802"
    assert error.message == "robot ended unexpectedly: exit status 4, and was started 5 times within 60 s"
    assert "no camera" in error.hint


@DEATHS
async def test_an_adapter_is_expected_back_until_it_is_ready_again(system: System, death: signal.Signals):
    async with system.up(small("robot", is_adapter=True, is_restarted=True)) as supervisor:
        await supervisor.until_ready()
        async with asyncio.timeout(HANG_S), supervisor.bus.presence(supervisor.keys.all_returning) as told:
            os.kill(descendants(supervisor.pids["robot"])[-1], death)
            assert await anext(told) == (supervisor.keys.returning("robot"), True)
            await system.until("robot", "ready", times=2)
            is_expected = True
            while is_expected or told.has_items:  # A silence and the end that follows are told apart.
                _, is_expected = await anext(told)
    (end,) = system.ends
    assert (end.name, end.how, end.then) == ("robot", "killed by SIGKILL", "it is started again")


async def test_a_command_that_cannot_be_started_is_not_tried_again(system: System):
    error = await system.error(command("./no_such_program", is_restarted=True))
    assert system.order("ended") == ["robot", "router"]
    assert error.code == "AOS802"
    assert "cannot start ./no_such_program: No such file or directory" in error.hint
