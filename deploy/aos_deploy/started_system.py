"""Systems that a program starts: `aos-up` in a session of its own, and a client of its run.

async with started_system("armadillo.yaml", "--stay") as aos:
    async for record in aos.decisions():
        print(record.step, record.action)
"""

import asyncio
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import IO

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import RUNS, living_runs
from aos_protocol.access import OPERATOR
from aos_protocol.errors import AosError, error_from_code
from aos_runtime.client import AosClient

_UP = (sys.executable, "-c", "from aos_deploy.cli import up_main; up_main()")
_LOOK_S = 0.05
_SAID_BYTES = 4000
_CONNECT_TIMEOUT_S = 30.0


@asynccontextmanager
async def started_system(
    deploy_file: str | Path, *options: str, runs: str | Path = RUNS
) -> AsyncIterator[AosClient]:
    """Starts the system of a deploy file and its first mission, and gives a client as its operator.

    `options` are those of `aos-up`. The end of the block ends the system, as Ctrl-C does; it goes on where
    this process is killed. AosError with what `aos-up` has said where it does not come to a run.
    """
    with tempfile.TemporaryFile() as said:
        process = started_process(Path(deploy_file), Path(runs), options, said)
        try:
            run = await until_run(process, said)
            async with AosClient.of_run(run.path, OPERATOR, connect_timeout_s=_CONNECT_TIMEOUT_S) as client:
                yield client
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            await asyncio.to_thread(process.wait)


def started_process(
    deploy_file: Path, runs: Path, options: Iterable[str], said: IO[bytes]
) -> subprocess.Popen[bytes]:
    """The `aos-up` of a deploy file, which the end of this process does not end.

    It says in the file `said` why it fails.
    """
    command = [*_UP, str(deploy_file), "--plain", "--runs", str(runs), *options]
    null = subprocess.DEVNULL
    return subprocess.Popen(command, stdin=null, stdout=null, stderr=said, start_new_session=True)


async def until_run(process: subprocess.Popen[bytes], said: IO[bytes]) -> RunDirectory:
    """The run of an `aos-up`, once it can be found; AosError with what was `said` where it ended before."""
    while process.poll() is None:
        for run in await asyncio.to_thread(living_runs):
            try:
                is_it = run.read_record().pid == process.pid
            except AosError:
                continue
            if is_it:
                return run
        await asyncio.sleep(_LOOK_S)
    said.seek(0)
    raise _error_of(said.read(_SAID_BYTES).decode("utf-8", "replace"), process.returncode)


def _error_of(said: str, status: int) -> AosError:
    """The fault that aos-up has printed, and below it the findings that it has printed before."""
    lines = [line for line in said.splitlines() if line.strip()]
    last = lines[-1] if lines else f"aos-up ended with status {status}"
    code = re.search(r"\bAOS\d{3}\b", last)
    text = last.partition(f"{code[0]}: ")[2] if code else last
    return error_from_code(code[0] if code else "AOS802", "\n".join([text or last, *lines[:-1]]))
