import os
import pty
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
def test_a_signal_after_the_end_leaves_the_exit_code(signal):
    ended = subprocess.run(
        [sys.executable, "-c", RUN.format(signal=signal)], timeout=HANG_S, capture_output=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (6, b"")


TWICE = """
import asyncio, os, signal
from aos_deploy import interruption

class Goes:
    exit_code = 130
    async def run(self):
        try:
            {first}
            await asyncio.Event().wait()
        except asyncio.CancelledError:
            os.kill(os.getpid(), signal.SIGTERM)
            for _ in range(10):
                await asyncio.sleep(0)
            print("stopped in order")
            return self
    def kill(self):
        print("killed")

interruption.ECHO_S = {echo_s}
is_unread = asyncio.Event()
asyncio.run(interruption.run_until_interrupted(Goes(), is_unread))
"""


@pytest.mark.parametrize(
    ("first", "echo_s"), [("os.kill(os.getpid(), signal.SIGTERM)", HANG_S), ("is_unread.set()", -1.0)]
)
def test_a_signal_that_comes_twice_at_once_or_after_the_reader_has_gone_is_one(first, echo_s):
    script = TWICE.format(first=first, echo_s=echo_s)
    ended = subprocess.run(
        [sys.executable, "-c", script], timeout=HANG_S, capture_output=True, check=False, text=True
    )
    assert (ended.stdout, ended.stderr) == ("stopped in order\n", "")


TELLS = """
import asyncio, sys
from aos_deploy.interruption import told_while_read

is_unread = asyncio.Event()
tell = told_while_read(lambda event: print(event, flush=True), is_unread)
input()
tell("one")
tell("another")
sys.exit(7 if is_unread.is_set() else 1)
"""


WAITS = """
import asyncio, os
from aos_deploy.interruption import run_until_interrupted

class Waits:
    exit_code = 0
    async def run(self):
        os.write(1, b"it waits")
        await asyncio.Event().wait()

try:
    asyncio.run(run_until_interrupted(Waits(), asyncio.Event()))
except asyncio.CancelledError:
    raise SystemExit(7)
"""


def test_a_terminal_that_is_closed_ends_a_run_that_tells_nothing():
    terminal, inside = pty.openpty()
    with subprocess.Popen([sys.executable, "-c", WAITS], stdout=inside, stderr=subprocess.PIPE) as running:
        os.close(inside)
        assert b"it waits" in os.read(terminal, 100)
        os.close(terminal)
        _, said = running.communicate(timeout=HANG_S)
    assert (running.returncode, said) == (7, b"")


def test_a_terminal_that_is_closed_reads_no_more():
    terminal, inside = pty.openpty()
    with subprocess.Popen(
        [sys.executable, "-c", TELLS], stdin=subprocess.PIPE, stdout=inside, stderr=subprocess.PIPE
    ) as telling:
        os.close(inside)
        os.close(terminal)
        _, said = telling.communicate(b"\n", timeout=HANG_S)
    assert (telling.returncode, said) == (7, b"")
