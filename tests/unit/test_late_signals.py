"""A signal that comes when the mission is over."""

from __future__ import annotations

import subprocess
import sys

import pytest
from processes import HANG_S

RUN = """
import asyncio, os, signal, sys
from aos_deploy.interruption import run_until_interrupted

class Over:
    exit_code = 6
    async def run(self):
        return self
    def kill(self):
        pass

code = asyncio.run(run_until_interrupted(Over(), asyncio.Event()))
os.kill(os.getpid(), signal.{signal})
sys.exit(code)
"""


@pytest.mark.parametrize("signal", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_after_the_end_leaves_the_exit_code(signal: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", RUN.format(signal=signal)], timeout=HANG_S, capture_output=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (6, b"")
