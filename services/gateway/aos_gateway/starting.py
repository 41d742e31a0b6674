"""Systems that the gateway starts: `aos-up` in a session of its own, which goes on when the gateway ends."""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import IO

import msgspec

from aos_deploy.living_runs import living_runs
from aos_gateway.runs import RunShelf
from aos_protocol.errors import AosError, error_from_code

__all__ = ["StartedRun", "start_system"]

_UP = (sys.executable, "-c", "from aos_deploy.cli import up_main; up_main()")
_LOOK_S = 0.05
_SAID_BYTES = 4000


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
        process = _started([*_UP, str(deploy_file), "--plain", "--runs", str(runs), *options], said)
        _reap(process)
        while process.returncode is None:
            for run in await asyncio.to_thread(living_runs):
                try:
                    is_it = run.read_record().pid == process.pid
                except AosError:
                    continue
                if is_it:
                    first = (await shelf.run(run.path.name).entry()).missions[:1]
                    return StartedRun(run.path.name, first[0] if first else run.path.name)
            await asyncio.sleep(_LOOK_S)
        said.seek(0)
        raise _error_of(said.read(_SAID_BYTES).decode("utf-8", "replace"), process.returncode)


def _started(command: list[str], said: IO[bytes]) -> subprocess.Popen[bytes]:
    """Starts a process that the end of this one does not end; one of asyncio's would be killed then."""
    null = subprocess.DEVNULL
    return subprocess.Popen(command, stdin=null, stdout=null, stderr=said, start_new_session=True)


def _reap(process: subprocess.Popen[bytes]) -> None:
    """Takes the exit code when the process ends, so that no zombie stays."""
    loop = asyncio.get_running_loop()
    handle = os.pidfd_open(process.pid)

    def ended() -> None:
        loop.remove_reader(handle)
        os.close(handle)
        process.wait()

    loop.add_reader(handle, ended)


def _error_of(said: str, status: int) -> AosError:
    """The fault that aos-up has printed."""
    lines = [line for line in said.splitlines() if line.strip()]
    last = lines[-1] if lines else f"aos-up ended with status {status}"
    code = re.search(r"\bAOS\d{3}\b", last)
    text = last.partition(f"{code[0]}: ")[2] if code else last
    return error_from_code(code[0] if code else "AOS802", text or last)
