import os
import socket
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import msgspec
import pytest
import pytest_asyncio
from middleware_system import System, running_system
from places import BUNDLES
from processes import HANG_S, has_listener
from ros1_core import roscore, skip_without_ros1

from aos_language.load import read_bundle_files
from aos_protocol.keys import Keys
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.parent import PARENT_VARIABLE
from aos_runtime.processes.settings import ServiceSettings


def free_endpoint() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


@pytest.fixture(scope="module")
def endpoint(tmp_path_factory) -> Iterator[str]:
    """The address of the module's router, which listens by then, however long its start takes."""
    folder: Path = tmp_path_factory.mktemp("router")
    settings = ServiceSettings(robot="test", service="router", endpoint=free_endpoint(), run_dir=str(folder))
    path = folder / "router.json"
    path.write_bytes(msgspec.json.encode(settings))
    with subprocess.Popen(
        [sys.executable, "-m", "aos_runtime.router", str(path)],
        env={**os.environ, PARENT_VARIABLE: str(os.getpid()), "AOS_LOG": "WARNING"},
    ) as router:
        port, deadline_s = int(settings.endpoint.rpartition(":")[2]), time.monotonic() + HANG_S
        while not has_listener(port) and router.poll() is None:
            assert time.monotonic() < deadline_s, "the router does not listen"
            time.sleep(0.02)
        yield settings.endpoint
        router.terminate()


@pytest.fixture
def keys() -> Keys:
    return Keys("test")


@pytest_asyncio.fixture
async def bus(endpoint: str) -> AsyncIterator[Bus]:
    async with await Bus.open(endpoint, sender="client") as client:
        yield client


@pytest_asyncio.fixture
async def other(endpoint: str) -> AsyncIterator[Bus]:
    """A second client, named `other`: what services are on the bus for."""
    async with await Bus.open(endpoint, sender="other") as client:
        yield client


@pytest_asyncio.fixture
async def system(bus: Bus, other: Bus, keys: Keys, endpoint: str, tmp_path) -> AsyncIterator[System]:
    """A middleware that has our armadillo, and a skill that listens; `other` surrounds it."""
    async with running_system(bus, other, keys, tmp_path, endpoint, BUNDLES / "armadillo-finer") as running:
        yield running


@pytest_asyncio.fixture
async def process_system(bus: Bus, other: Bus, keys: Keys, endpoint: str, tmp_path) -> AsyncIterator[System]:
    """The same with a middleware that is a process, which a test may freeze, end and start again."""
    bundle = BUNDLES / "armadillo-finer"
    async with running_system(bus, other, keys, tmp_path, endpoint, bundle, is_process=True) as running:
        yield running


@pytest.fixture
def finer() -> dict[str, bytes]:
    return read_bundle_files(BUNDLES / "armadillo-finer")[0]


@pytest.fixture(scope="module")
def master(tmp_path_factory) -> Iterator[str]:
    skip_without_ros1()
    with roscore(tmp_path_factory.mktemp("ros")) as uri:
        yield uri
