"""Child processes of a service or of aos-up, on asyncio.

Start children from the main thread: they end with the thread that started them, see `parent`.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
import time
from collections.abc import Awaitable, Iterable, Mapping
from pathlib import Path
from typing import IO, Any, Literal, Self, TypedDict, TypeVar, Unpack

import msgspec

from aos_protocol.errors import DeployError
from aos_runtime.processes.parent import PARENT_VARIABLE
from aos_runtime.sandbox.support import require_sandbox, sandbox_support

PIPE = asyncio.subprocess.PIPE

Stdio = int | IO[Any] | None
T = TypeVar("T")

MOST_DEADLINES = 10
"""The most deadlines that a child has which others keep from the processors."""
_LEAST_STARVED = 0.05
"""A child that waited for a processor for less than this share of its deadline has had its time."""

_LAUNCH_GUARD = (
    "import sys; sys.path.insert(0, sys.argv[1]); "
    "from aos_runtime.processes.guard import main; main(sys.argv[2:])"
)


class Streams(TypedDict, total=False):
    """The standard streams of a child, as `subprocess` takes them."""

    stdin: Stdio
    stdout: Stdio
    stderr: Stdio


class Limits(msgspec.Struct, frozen=True, kw_only=True):
    """The limits of a guarded command; None is unlimited. `grace_s` lies between SIGTERM and SIGKILL,
    `left_behind_s` for what a command that ended by itself has left behind; None is the grace.

    The `niceness` is added to this process's own: of a command with 19, all others come first.
    """

    address_space_bytes: int | None = None
    cpu_s: int | None = None
    file_bytes: int | None = None
    niceness: int | None = None
    grace_s: float = 0.5
    left_behind_s: float | None = None


class Confinement(msgspec.Struct, frozen=True, kw_only=True):
    """The sandbox of a command: its profile, and the files and folders that it may read, execute as well, or
    write as well. What does not exist is left out.

    A command that `is_ours` has nothing of documents in it, and runs also where it cannot be confined.
    """

    profile: Literal["compiler", "engine", "worker"]
    read: tuple[str, ...] = ()
    execute: tuple[str, ...] = ()
    write: tuple[str, ...] = ()
    is_ours: bool = False


def guarded(
    command: list[str], limits: Limits | None = None, confinement: Confinement | None = None
) -> list[str]:
    """The command line that runs `command` under `guard`, so that nothing of it stays behind.

    DeployError AOS805 if it is to be confined, and cannot be, unless documents are trusted.
    """
    options: list[str] = []
    if confinement is not None:
        options += _options_of(confinement)
    for name, value in msgspec.structs.asdict(limits or Limits()).items():
        if value is not None:
            options += [f"--{name.replace('_', '-')}", str(value)]
    packages = str(Path(__file__).parents[2])
    return [sys.executable, "-I", "-S", "-c", _LAUNCH_GUARD, packages, *options, "--", *command]


def _options_of(confinement: Confinement) -> list[str]:
    if not confinement.is_ours:
        require_sandbox()
    options = ["--profile", confinement.profile]
    for kind in ("read", "execute", "write"):
        for path in getattr(confinement, kind):
            options += [f"--{kind}", path]
    return options if sandbox_support().is_whole else [*options, "--trust", "yes"]


class Child:
    """A process in a session of its own, so that Ctrl-C at the terminal reaches only who started it.

    A Python child of AOS ends with this process by `die_with_parent`; wrap any other program in `guarded`.
    """

    def __init__(self, process: asyncio.subprocess.Process, name: str) -> None:
        self.name = name
        self._process = process

    @classmethod
    async def start(
        cls,
        argv: list[str],
        *,
        name: str = "",
        cwd: str | os.PathLike[str] | None = None,
        env: Mapping[str, str] | None = None,
        pass_fds: Iterable[int] = (),
        stream_limit_bytes: int = 2**16,
        **streams: Unpack[Streams],
    ) -> Self:
        """Starts `argv`; `env` adds to this process's environment. DeployError AOS802 if it cannot be.

        It has no input, and this process's own output and error output, where `streams` says nothing else.
        """
        environment = {**os.environ, **(env or {}), PARENT_VARIABLE: str(os.getpid())}
        try:
            process = await asyncio.create_subprocess_exec(
                *argv,
                cwd=cwd,
                env=environment,
                stdin=streams.get("stdin", asyncio.subprocess.DEVNULL),
                stdout=streams.get("stdout"),
                stderr=streams.get("stderr"),
                pass_fds=tuple(pass_fds),
                limit=stream_limit_bytes,
                start_new_session=True,
            )
        except OSError as error:
            raise DeployError(f"cannot start {argv[0]}: {error.strerror}", code="AOS802") from error
        return cls(process, name or argv[0])

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def returncode(self) -> int | None:
        """The exit status, or minus the signal that ended it; None while it runs."""
        return self._process.returncode

    def is_frozen(self) -> bool:
        """Returns whether a signal such as SIGSTOP has stopped it, or a process that it or one of its has
        started."""
        return self.returncode is None and _is_stopped(self.pid)

    async def in_time(self, awaited: Awaitable[T], deadline_s: float, *, spent_s: float = 0.0) -> T:
        """The result of what it does; TimeoutError where that takes it longer than `deadline_s`.

        The time in which it waits for a processor that others have does not count, up to nine deadlines. The
        first twentieth of a deadline counts whole. A deadline that counts from the child's start gives what
        is `spent_s` already.
        """
        task = asyncio.ensure_future(awaited)
        last_s = time.monotonic() + MOST_DEADLINES * deadline_s - spent_s
        least_s = _LEAST_STARVED * deadline_s
        try:
            # Most answers come at once. To ask the kernel at each took a third of what decides and records.
            await asyncio.wait({task}, timeout=least_s)
            left_s = deadline_s - least_s - spent_s
            starved_s = 0.0 if task.done() or spent_s else self._starved_s()
            while not task.done():
                if left_s > 0 and (await asyncio.wait({task}, timeout=left_s))[0]:
                    break
                before_s, starved_s = starved_s, self._starved_s()
                left_s = min(min(left_s, 0.0) + starved_s - before_s, last_s - time.monotonic())
                if left_s <= least_s:
                    break
            if not task.done():
                raise TimeoutError
            return task.result()
        finally:
            task.cancel()
            await asyncio.wait({task})  # Who asks next may read at once.

    def _starved_s(self) -> float:
        """Returns for how long it and its children waited for a processor; 0 where the kernel is silent."""
        return 0.0 if self.returncode is not None else _scheduled_s(self.pid)[1]

    def ran_s(self) -> float:
        """Returns for how long it and its children had a processor; 0 where the kernel is silent."""
        return 0.0 if self.returncode is not None else _scheduled_s(self.pid)[0]

    @property
    def stdin(self) -> asyncio.StreamWriter:
        """Its input, if started with PIPE."""
        assert self._process.stdin is not None
        return self._process.stdin

    @property
    def stdout(self) -> asyncio.StreamReader:
        """Its output, if started with PIPE."""
        assert self._process.stdout is not None
        return self._process.stdout

    @property
    def stderr(self) -> asyncio.StreamReader:
        """Its error output, if started with PIPE."""
        assert self._process.stderr is not None
        return self._process.stderr

    async def wait(self) -> int:
        """Its return code, once it has ended."""
        status = await self._process.wait()
        stdin = self._process.stdin
        if stdin is not None:
            if not stdin.is_closing():
                stdin.transport.abort()
            # Before 3.11.4 Python logs that an input broke, unless somebody asks for it.
            with contextlib.suppress(ConnectionError):
                await stdin.wait_closed()
        return status

    async def wait_for(self, timeout_s: float) -> bool:
        """Waits until it has ended, at most for a time as `in_time` counts it; returns whether it has."""
        try:
            await self.in_time(self.wait(), timeout_s)
        except TimeoutError:
            return False
        return True

    async def stop(self, grace_s: float = 2.0) -> int:
        """Sends SIGTERM to its group, and SIGKILL after `grace_s`; returns its return code. Stopping twice
        does nothing.

        Give a guarded command more than the guard's own grace.
        """
        if self.returncode is None:
            self._signal(signal.SIGTERM)
            if not await self.wait_for(grace_s):
                self.kill()
        return await self.wait()

    def kill(self) -> None:
        """Sends SIGKILL to its group, now."""
        self._signal(signal.SIGKILL)

    def end_at_once(self) -> None:
        """Has the guard of a guarded command end all of it, now; killed, a guard would leave some behind."""
        self._signal(signal.SIGQUIT)

    def _signal(self, number: signal.Signals) -> None:
        if self.returncode is not None:
            return
        # A guard that SIGSTOP has stopped hears nothing, nor does its keeper.
        stopped = [pid for pid in (self.pid, *_children(self.pid)) if _state(pid) == "T"]
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, number)
        for pid in stopped:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)


def _children(pid: int) -> list[int]:
    try:
        return [int(word) for word in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []


def _scheduled_s(pid: int) -> tuple[float, float]:
    """The time on a processor, and that of waiting for one, of a process and its children."""
    try:
        ran_ns, waited_ns, *_ = map(int, Path(f"/proc/{pid}/schedstat").read_text().split())
    except (OSError, ValueError):
        return 0.0, 0.0
    below = [_scheduled_s(child) for child in _children(pid)]
    return ran_ns / 1e9 + sum(ran for ran, _ in below), waited_ns / 1e9 + sum(waited for _, waited in below)


def _state(pid: int) -> str:
    try:
        # The state follows the name, which may itself have brackets.
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return ""


def _is_stopped(pid: int) -> bool:
    return _state(pid) == "T" or any(map(_is_stopped, _children(pid)))
