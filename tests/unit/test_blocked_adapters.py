"""An adapter whose call holds up its event loop ends, and one that only takes long goes on."""

import subprocess
import sys
from pathlib import Path

import pytest
from processes import COMMAND_S

PROGRAM = """
import asyncio, time
from aos_runtime.adapters.blocking import ends_if_blocked

async def call():
    with ends_if_blocked("/sense", 0.1):
        {takes_time}
    print("went on")

asyncio.run(call())
"""


@pytest.mark.parametrize(
    ("takes_time", "status"), [("time.sleep(1000)", 1), ("await asyncio.sleep(0.5)", 0), ("pass", 0)]
)
def test_only_a_loop_that_stands_still_ends_the_process(tmp_path: Path, takes_time: str, status: int) -> None:
    robot = tmp_path / "robot.py"
    robot.write_text(PROGRAM.format(takes_time=takes_time))
    done = subprocess.run([sys.executable, robot], capture_output=True, text=True, timeout=COMMAND_S)
    assert done.returncode == status, done.stderr
    assert ("went on" in done.stdout) == (status == 0)
    if status:
        assert f"/sense holds up everything at {robot}:7, and cannot be stopped" in done.stderr
