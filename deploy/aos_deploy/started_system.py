"""Systems that a program starts: `aos-up` in a session of its own, and a client of its run.

async with started_system("armadillo.yaml", "--stay") as aos:
    async for record in aos.decisions():
        print(record.step, record.action)
"""

import asyncio
import signal
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator, Coroutine, Iterable
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import IO, Any, TypeVar

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import RUNS, living_runs
from aos_protocol.access import OPERATOR
from aos_protocol.errors import AosError, error_from_code
from aos_runtime.client import AosClient

T = TypeVar("T")

_UP = (sys.executable, "-c", "from aos_deploy.cli import up_main; up_main()")
_LOOK_S = 0.05
_SAID_BYTES = 4000
_CONNECT_TIMEOUT_S = 30.0


@asynccontextmanager
async def started_system(
    deploy_file: str | Path, *options: str, runs: str | Path = RUNS
) -> AsyncIterator[AosClient]:
    """Starts the system of a deploy file and its first mission, and gives a client as its operator.

    `options` are those of `aos-up`. The block begins when the solver can be asked. Its end ends the
    system, as Ctrl-C does; it goes on where this process is killed. AosError with what `aos-up` has said
    where it ends before a mission has begun.
    """
    with tempfile.TemporaryFile() as said:
        process = started_process(Path(deploy_file), Path(runs), options, said)
        try:
            run = await until_run(process, said)
            async with AsyncExitStack() as stack:
                client = await _while_it_runs(process, said, _client_of(run, stack))
                yield client
            if process.poll() is not None and (end := run.read_summary()) and end.ending == "not_started":
                raise _error_of(said, process.returncode)
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


async def _client_of(run: RunDirectory, stack: AsyncExitStack) -> AosClient:
    """A client as the operator of a system, once its solver answers; `stack` ends it."""
    connected = AosClient.of_run(run.path, OPERATOR, connect_timeout_s=_CONNECT_TIMEOUT_S)
    client = await stack.enter_async_context(connected)
    async with client.bus.presence(client.keys.live("solver")) as solver:
        while not (await anext(solver))[1]:
            pass
    return client


async def _while_it_runs(
    process: subprocess.Popen[bytes], said: IO[bytes], work: Coroutine[Any, Any, T]
) -> T:
    """Returns what `work` returns; AosError with what was `said` where the process ends before."""
    task = asyncio.create_task(work)
    try:
        while not task.done():
            await asyncio.wait([task], timeout=_LOOK_S)
            if process.poll() is not None:
                raise _error_of(said, process.returncode)
        return task.result()
    finally:
        task.cancel()
        await asyncio.wait([task])


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
    raise _error_of(said, process.returncode)


def _error_of(said: IO[bytes], status: int) -> AosError:
    """The fault that aos-up has printed, and below it the findings that it has printed before."""
    said.seek(0)
    text = said.read(_SAID_BYTES).decode("utf-8", "replace").strip() or f"aos-up ended with status {status}"
    before, fault, told = text.rpartition("aos-up: AOS")
    if not fault:
        return error_from_code("AOS802", text)
    code, _, reason = told.partition(": ")
    return error_from_code(f"AOS{code}", f"{reason}\n{before}".strip())
