"""The end of a process that does not take its objects apart: nothing that waits for it is lost."""

import subprocess
import sys

import pytest
from processes import COMMAND_S

END = "import atexit, sys, threading; from aos_runtime.processes.ending import end\n"


def ended(code: str) -> subprocess.CompletedProcess[str]:
    program = (sys.executable, "-c", END + code)
    return subprocess.run(program, capture_output=True, text=True, timeout=COMMAND_S)


@pytest.mark.parametrize("status", [0, 3])
def test_a_process_ends_with_its_status_its_output_and_what_is_to_be_done_at_its_end(status):
    done = ended(f"atexit.register(print, 'at exit')\nprint('said')\nend({status})")
    assert (done.returncode, done.stdout, done.stderr) == (status, "said\nat exit\n", "")


def test_objects_that_are_left_are_not_taken_apart():
    assert (
        ended("class Left:\n    def __del__(self): print('taken apart')\nleft = Left()\nend(0)").stdout == ""
    )


def test_a_thread_is_waited_for():
    code = "begun = threading.Event()\ndef work():\n    begun.wait()\n    print('done')\n"
    assert ended(code + "threading.Thread(target=work).start()\nbegun.set()\nend(0)").stdout == "done\n"


def test_an_output_that_cannot_be_written_is_told_as_python_tells_it():
    done = ended("sys.stdout = open('/dev/full', 'w')\nprint('said')\nend(0)")
    assert (done.returncode, "No space left on device" in done.stderr) == (120, True)
