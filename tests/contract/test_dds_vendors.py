"""Topics over DDS with a program of another vendor: Cyclone DDS here, Fast DDS there."""

from __future__ import annotations

import asyncio
import os
import random
import shutil
import subprocess
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rosbags", reason="needs the extra `dds`")
pytest.importorskip("cyclonedds", reason="needs the extra `dds`")

from aos_protocol.errors import BusError
from aos_skills.dds.node import DdsNode
from aos_skills.ros.types import RosTypes

ROOT = Path(__file__).resolve().parents[2]
HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")
STRING = "std_msgs/msg/String"
DEADLINE_S = 20.0


@pytest.fixture(scope="module")
def fast_dds_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The other vendor's program, compiled."""
    compiler = shutil.which("g++")
    if not HEADER.exists() or compiler is None:
        pytest.skip("needs g++ and Debian's libfastrtps-dev")
    program = tmp_path_factory.mktemp("fast_dds") / "peer"
    source = ROOT / "tests" / "cpp" / "fast_dds_peer.cpp"
    command = [compiler, "-std=c++17", str(source), "-o", str(program), "-lfastrtps", "-lfastcdr"]
    subprocess.run(command, check=True, timeout=200)
    return program


async def test_fast_dds_understands_us_and_we_it(fast_dds_program: Path) -> None:
    domain = random.SystemRandom().randint(1, 100)
    peer = await asyncio.create_subprocess_exec(fast_dds_program, str(domain), env=os.environ)
    try:
        async with DdsNode(RosTypes(), domain=domain) as node:
            received: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
            found = await node.topic("/from_fast", DEADLINE_S)
            assert found is not None
            assert (found.type_name, found.qos.is_reliable) == (STRING, True)
            node.subscribe("/from_fast", STRING, received.put_nowait, found.qos)
            publish = node.publisher("/to_fast", STRING)
            # What is published before the two have found each other is lost.
            async for answer in _answers(received):
                if answer is not None:
                    assert answer == {"data": "LOUD"}
                    break
                publish({"data": "loud"})
    finally:
        peer.kill()
        await peer.wait()


async def _answers(received: asyncio.Queue[dict[str, Any]]) -> AsyncIterator[dict[str, Any] | None]:
    """Each answer as it comes, and None when there was none for a while."""
    async with asyncio.timeout(DEADLINE_S):
        while True:
            try:
                yield await asyncio.wait_for(received.get(), 0.05)
            except TimeoutError:
                yield None


async def test_a_network_interface_that_is_not_there_is_an_error_that_says_so() -> None:
    with pytest.raises(BusError, match=r"DDS cannot be used on the network interface nonesuch0") as raised:
        DdsNode(RosTypes(), domain=1, interface="nonesuch0")
    assert raised.value.code == "AOS605"
