import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import msgspec
import pytest
from processes import HANG_S, descendants, until_ended
from small_service import Settings

from aos_protocol.keys import Keys
from aos_protocol.messages import Fault
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import PIPE, Child
from aos_runtime.processes.settings import ROUTER_S, fault_path

TESTS = Path(__file__).parents[1]


class Host:
    def __init__(self, run_dir: Path, endpoint: str):
        self.run_dir = run_dir
        self._endpoint = endpoint

    def settings(self, service: str, mood: str = "good", router_s: float = ROUTER_S) -> Path:
        settings = Settings(
            robot="test",
            service=service,
            endpoint=self._endpoint,
            run_dir=str(self.run_dir),
            router_s=router_s,
            mood=mood,
        )
        path = self.run_dir / f"{service}.json"
        path.write_bytes(msgspec.json.encode(settings))
        return path

    @asynccontextmanager
    async def running(
        self, service: str, mood: str = "good", router_s: float = ROUTER_S
    ) -> AsyncIterator[Child]:
        argv = [sys.executable, "-m", "small_service", str(self.settings(service, mood, router_s))]
        child = await Child.start(argv, env={"PYTHONPATH": str(TESTS)}, stderr=PIPE)
        try:
            yield child
        finally:
            child.kill()
            await child.wait()

    def fault(self, service: str) -> Fault:
        return msgspec.json.decode(fault_path(self.run_dir, service).read_bytes(), type=Fault)


@pytest.fixture
def host(tmp_path, endpoint: str) -> Host:
    return Host(tmp_path, endpoint)


async def test_a_service_is_present_while_it_runs_and_cleans_up_when_told_to_stop(
    host: Host, bus: Bus, keys: Keys
):
    async with bus.presence(keys.live("garden")) as changes, host.running("garden") as child:
        assert await anext(changes) == (keys.live("garden"), True)
        assert await child.stop() == 0
        assert await anext(changes) == (keys.live("garden"), False)
    assert (host.run_dir / "stopped").read_text() == "garden\n"
    assert not fault_path(host.run_dir, "garden").exists()


async def test_a_second_service_of_a_name_is_refused(host: Host, bus: Bus, keys: Keys):
    async with bus.presence(keys.live("garden")) as changes, host.running("garden") as first:
        await anext(changes)
        async with host.running("garden") as second:
            assert await second.wait() == 1
        assert host.fault("garden").code == "AOS803"
        assert first.returncode is None


async def test_a_service_without_a_router_says_so(tmp_path, unused_tcp_port: int):
    host = Host(tmp_path, f"tcp/127.0.0.1:{unused_tcp_port}")
    async with host.running("garden", router_s=0.1) as child:
        assert await child.wait() == 1
    assert host.fault("garden").code == "AOS605"


async def test_wrong_settings_are_a_usage_error(tmp_path):
    path = tmp_path / "settings.json"
    path.write_text('{"robot": "test"}')
    argv = [sys.executable, "-m", "small_service", str(path)]
    child = await Child.start(argv, env={"PYTHONPATH": str(TESTS)}, stderr=PIPE)
    assert await child.wait() == 1
    assert b"missing required field `service`" in await child.stderr.read()


START_A_SERVICE = """
import asyncio, sys
from aos_runtime.processes.children import Child
async def main():
    child = await Child.start([sys.executable, "-m", "small_service", sys.argv[1]])
    print(child.pid, flush=True)
    await child.wait()
asyncio.run(main())
"""


@pytest.mark.parametrize("mood", ["good", "parental"])
async def test_a_service_ends_with_its_parent(host: Host, bus: Bus, keys: Keys, mood):
    argv = [sys.executable, "-c", START_A_SERVICE, str(host.settings("garden", mood))]
    parent = await Child.start(argv, env={"PYTHONPATH": str(TESTS)}, stdout=PIPE)
    async with bus.presence(keys.live("garden")) as changes, asyncio.timeout(HANG_S):
        pid = int(await parent.stdout.readline())
        assert await anext(changes) == (keys.live("garden"), True)
        below = [pid, *descendants(pid)]
        os.kill(parent.pid, signal.SIGKILL)
        assert await anext(changes) == (keys.live("garden"), False)
        await until_ended(below)
    await parent.wait()
