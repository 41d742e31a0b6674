import asyncio
import random
import shutil
import subprocess
import sys
from ctypes.util import find_library
from pathlib import Path

import pytest
from places import ROOT
from processes import COMMAND_S, finished

pytest.importorskip("rosbags", reason="needs the extra `dds`")
pytest.importorskip("cyclonedds", reason="needs the extra `dds`")

from aos_protocol.errors import BusError
from aos_skills.dds.node import DdsNode
from aos_skills.ros.types import RosTypes
from aos_solver.building.build_cache import BuildCache, digest_of

pytestmark = pytest.mark.slow

HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")


@pytest.fixture(scope="module")
def fast_dds_program(cache_dir: Path) -> Path:
    compiler = shutil.which("g++")
    if not HEADER.exists() or compiler is None:
        pytest.skip("needs g++ and Debian's libfastrtps-dev")
    source = ROOT / "tests" / "cpp" / "fast_dds_peer.cpp"
    command = [compiler, "-std=c++17", str(source), "-o", "peer", "-lfastrtps", "-lfastcdr"]
    version = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout

    async def make(folder: Path):
        await asyncio.to_thread(subprocess.run, command, cwd=folder, check=True, timeout=COMMAND_S)

    library = find_library("fastrtps") or ""  # with its version
    name = f"fast-dds-{digest_of([source.read_text(), *command, version, library])}"
    return asyncio.run(BuildCache(cache_dir).fill(name, make)) / "peer"


def test_fast_dds_understands_us_and_we_it(fast_dds_program: Path):
    domain = str(random.SystemRandom().randint(1, 100))
    with subprocess.Popen([fast_dds_program, domain]) as peer:
        try:
            partner = [sys.executable, str(ROOT / "tests" / "fast_dds_partner.py"), domain]
            talk = finished(*partner)
        finally:
            peer.kill()
    assert talk.returncode == 0, talk.stderr


async def test_a_network_interface_that_is_not_there_is_an_error_that_says_so():
    with pytest.raises(BusError, match=r"DDS cannot be used on the network interface nonesuch0") as raised:
        DdsNode(RosTypes(), domain=1, interface="nonesuch0")
    assert raised.value.code == "AOS605"
