"""Systems that the gateway starts, and that go on when the gateway ends."""

import asyncio
import os
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path

import msgspec

from aos_deploy.started_system import started_process, until_run
from aos_gateway.runs.shelf import RunShelf


class StartedRun(msgspec.Struct, frozen=True):
    """The run of a system that was started, and the name of its first mission."""

    run: str
    mission: str


async def start_system(shelf: RunShelf, deploy_file: Path, runs: Path, options: Iterable[str]) -> StartedRun:
    """Starts `aos-up`, and returns once its run can be found; AosError with what it said where it ended
    before.

    `runs` is the folder of its run directory.
    """
    with tempfile.TemporaryFile() as said:
        process = started_process(deploy_file, runs, options, said)
        _reap(process)
        run = await until_run(process, said)
        first = (await shelf.run(run.path.name).entry()).missions[:1]
        return StartedRun(run.path.name, first[0] if first else run.path.name)


def _reap(process: subprocess.Popen[bytes]) -> None:
    """Takes the exit code when the process ends, so that no zombie stays."""
    loop = asyncio.get_running_loop()
    handle = os.pidfd_open(process.pid)

    def ended() -> None:
        loop.remove_reader(handle)
        os.close(handle)
        process.wait()

    loop.add_reader(handle, ended)
