"""A real roscore on loopback, for the tests of ROS 1; they skip where Debian's packages are not installed."""

import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from xmlrpc.client import ServerProxy

import pytest

from aos_runtime.processes.children import guarded
from aos_runtime.processes.parent import PARENT_VARIABLE

PYTHON = "/usr/bin/python3"
START_S = 120.0
NEEDED = "rospy, roslaunch, rosservice, actionlib, std_srvs.srv, geometry_msgs.msg"


@cache
def _has_ros1() -> bool:
    if not Path(PYTHON).exists() or shutil.which("roscore") is None:
        return False
    return (
        subprocess.run([PYTHON, "-c", f"import {NEEDED}"], capture_output=True, timeout=START_S).returncode
        == 0
    )


def skip_without_ros1() -> None:
    if not _has_ros1():
        pytest.skip(
            "needs Debian's python3-rospy, python3-roslaunch, python3-actionlib; .ci/run installs them"
        )


@contextmanager
def roscore(folder: Path) -> Iterator[str]:
    """The URI of a master that answers; it ends with the context."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    master = f"http://127.0.0.1:{port}"
    environment = {
        **os.environ,
        "ROS_MASTER_URI": master,
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(folder),
        PARENT_VARIABLE: str(os.getpid()),
    }
    environment.pop("PYTHONPATH", None)
    command = guarded([PYTHON, shutil.which("roscore") or "roscore", "-p", str(port)])
    with (
        (folder / "roscore.log").open("wb") as log,
        subprocess.Popen(command, env=environment, stdout=log, stderr=log) as core,
    ):
        try:
            _wait_for(master, core)
            yield master
        finally:
            core.terminate()


def _wait_for(master: str, core: subprocess.Popen[bytes]) -> None:
    ends_at = time.monotonic() + START_S
    while True:
        try:
            with ServerProxy(master) as proxy:
                proxy.getPid("/test")
        except OSError as error:
            if core.poll() is not None or time.monotonic() > ends_at:
                raise RuntimeError("roscore did not start; see roscore.log") from error
            time.sleep(0.05)
        else:
            return
