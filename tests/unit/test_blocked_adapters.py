import sys

import pytest
from processes import finished

PROGRAM = """
import asyncio, ctypes, time
from aos_runtime.adapters import results

async def call():
    with results.ends_if_blocked("/sense", 0.1):
        {takes_time}
    print("went on")

results._ANSWER_S = {answer_s}
asyncio.run(call())
"""


@pytest.mark.parametrize(
    ("takes_time", "told"),
    [
        ("time.sleep(1000)", "/sense holds up everything at {robot}:7, and cannot be stopped"),
        ("ctypes.PyDLL(None).sleep(1000)", 'File "{robot}", line 7'),  # It keeps the lock of Python.
        ("await asyncio.sleep(0.5)", ""),
        ("pass", ""),
    ],
)
def test_only_a_loop_that_stands_still_ends_the_process(tmp_path, takes_time, told):
    robot = tmp_path / "robot.py"
    # A loop that goes on has all the time that a busy machine may need.
    robot.write_text(PROGRAM.format(takes_time=takes_time, answer_s=0.1 if told else 60.0))
    done = finished(sys.executable, robot)
    assert done.returncode == bool(told), done.stderr
    assert ("went on" in done.stdout) == (not told)
    assert told.format(robot=robot) in done.stderr
