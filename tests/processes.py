import asyncio
import json
import os
import queue
import signal
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

HANG_S = 120.0
"""Tests wait this long for one event, which takes a second on an idle machine: only a hang takes longer."""

COMMAND_S = 600.0
"""Tests wait this long for a whole command, which may compile, plan and simulate."""


def finished(*command: str | Path, **options: Any) -> subprocess.CompletedProcess[str]:
    """A whole command and what it printed; `options` are those of `subprocess.run`."""
    return subprocess.run(command, capture_output=True, text=True, timeout=COMMAND_S, **options)


def is_running(pid: int) -> bool:
    """Returns whether a process does anything still; a zombie does not."""
    try:
        status = Path(f"/proc/{pid}/stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return status.rpartition(")")[2].split()[0] != "Z"


def descendants(pid: int) -> list[int]:
    below: list[int] = []
    for task in Path(f"/proc/{pid}/task").iterdir():
        children: list[str] = []
        with suppress(FileNotFoundError, ProcessLookupError):  # A thread may end meanwhile.
            children = (task / "children").read_text().split()
        for child in map(int, children):
            below.append(child)
            with suppress(FileNotFoundError, ProcessLookupError):
                below += descendants(child)
    return below


async def until_ended(pids: list[int], timeout_s: float = HANG_S) -> None:
    """Returns once none of them runs; TimeoutError if one goes on. They need not be children."""
    async with asyncio.timeout(timeout_s):
        for pid in pids:
            await _until_one_ended(pid)


async def kill_engine(pid: int | None) -> None:
    assert pid is not None
    children = descendants(pid)
    os.kill(pid, signal.SIGKILL)
    await until_ended(children)


async def _until_one_ended(pid: int) -> None:
    try:
        handle = os.pidfd_open(pid)
    except ProcessLookupError:
        return
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    loop.add_reader(handle, ended.set)  # It becomes readable when the process ends.
    try:
        await ended.wait()
    finally:
        loop.remove_reader(handle)
        os.close(handle)


def has_listener(port: int) -> bool:
    wanted = f":{port:04X}"
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in Path(table).read_text().splitlines()[1:]:
            fields = line.split()
            if fields[1].endswith(wanted) and fields[3] == "0A":
                return True
    return False


def kill(pid: int) -> None:
    os.kill(pid, signal.SIGKILL)


def until_taking_over(run: Path, revision: int) -> None:
    """Returns once the next decision of a run takes the model of this revision: solver and middleware have
    it."""
    deadline_s = time.monotonic() + HANG_S
    awaited = f"the model of revision {revision} is ready", f"the middleware has revision {revision}"
    while not all(text in (run / "logs" / "solver.log").read_text() for text in awaited):
        assert time.monotonic() < deadline_s, f"revision {revision} is not ready"
        time.sleep(0.02)


def events_of(process: subprocess.Popen[str]) -> Iterator[dict[str, Any]]:
    assert process.stdout is not None
    for line in process.stdout:
        yield json.loads(line)


class EventReader:
    """Reads what a running `aos-up --json` prints all the time, since it would wait for a reader."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self._events: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        for event in events_of(self._process):
            self._events.put(event)
        self._events.put(None)

    def next(self, kind: str, **fields: Any) -> dict[str, Any] | None:
        """The next event of a kind with these fields; None where the process ends before."""
        while (event := self._events.get(timeout=HANG_S)) is not None:
            if event["event"] == kind and fields.items() <= event.items():
                return event
        return None

    def kill(self) -> None:
        """Ends the process and reads the rest, before whoever started it closes its pipe."""
        self._process.kill()
        self._reader.join(HANG_S)

    def ended(self) -> int:
        """The exit code, once all is read."""
        self._reader.join(HANG_S)
        return self._process.wait(HANG_S)
