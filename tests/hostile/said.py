"""A command of AOS that runs beside this program, and what it has said so far.

It is forked from this program, which has imported what commands import: that saves half of the processor
time of a short command. A `fresh` command is a program of its own instead, as a user starts it.
"""

import atexit
import os
import resource
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import NoReturn

import aos_deploy.cli

DID_NOT_END = "(it did not end when it was told to)"
_COMMANDS: dict[str, Callable[[], NoReturn]] = {"aos": aos_deploy.cli.main, "aos-up": aos_deploy.cli.up_main}
_IMPORTED = (
    "aos_deploy.commands.bundle",
    "aos_deploy.commands.documents",
    "aos_deploy.commands.up",
    "aos_deploy.missions.mission_run",
    "aos_deploy.missions.system_run",
    "aos_runtime.client",
    "aos_solver.building.project_build",
)
_LOOKS_S = 0.02
_END_S = 240.0


def import_commands():
    for name in _IMPORTED:
        import_module(name)


def processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Command:
    """A command in a folder. What it says goes into the file `said`, so that it never waits for a reader."""

    def __init__(
        self, words: Sequence[str], folder: Path, environment: dict[str, str], said: Path, *, fresh: bool
    ):
        self._said = said
        self._status: int | None = None
        with said.open("wb") as output:
            if fresh:
                program = str(Path(sys.executable).with_name(words[0]))
                process = subprocess.Popen(
                    [program, *words[1:]], cwd=folder, env=environment, stdout=output, stderr=output
                )
                process.returncode = 0  # It is waited for here.
                self.pid = process.pid
            else:
                sys.stdout.flush()
                # Ctrl-C is to reach the child in its own code, and not in this program's.
                signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
                self.pid = os.fork()
                if self.pid == 0:
                    _become(words, folder, environment, output.fileno())
                signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})

    @property
    def said(self) -> str:
        return self._said.read_bytes().decode(errors="replace")

    @property
    def has_ended(self) -> bool:
        """Says whether it has, and takes its exit status."""
        if self._status is None:
            ended, status = os.waitpid(self.pid, os.WNOHANG)
            self._status = status if ended else None
        return self._status is not None

    def listen(self, words: str, timeout_s: float, *, after: int = 0) -> float | None:
        """Returns the time at which it has said the words, after so many bytes; None if it ends, or the time
        does, before."""
        ends_s = time.monotonic() + timeout_s
        with self._said.open("rb") as file:
            file.seek(after)
            heard = b""
            while True:
                has_ended = self.has_ended
                heard += file.read()
                if words.encode() in heard:
                    return time.monotonic()
                if has_ended or time.monotonic() > ends_s:
                    return None
                heard = heard[-len(words) :]
                time.sleep(_LOOKS_S)

    def listen_to_all(self, words: Iterable[str], timeout_s: float) -> Iterator[tuple[str, float]]:
        """Gives each of the words once they are said, with the seconds since those before them; ends if it
        does, or where nothing of them is said for so long."""
        missing = list(words)
        last_s = time.monotonic()
        while missing and time.monotonic() < last_s + timeout_s:
            has_ended = self.has_ended
            said = self.said
            for one in [one for one in missing if one in said]:
                now_s = time.monotonic()
                yield one, now_s - last_s
                missing.remove(one)
                last_s = now_s
            if has_ended:
                return
            time.sleep(_LOOKS_S)

    @property
    def said_bytes(self) -> int:
        return self._said.stat().st_size

    def end(self, after_s: float = 0.0) -> str:
        self._wait(after_s)
        if not self.has_ended:
            os.kill(self.pid, signal.SIGINT)
        self._wait(_END_S)
        if self._status is None:
            os.kill(self.pid, signal.SIGKILL)
            self._status = os.waitpid(self.pid, 0)[1]
            return f"{self.said}\n{DID_NOT_END}"
        return self.said

    def _wait(self, at_most_s: float):
        ends_s = time.monotonic() + at_most_s
        while not self.has_ended and time.monotonic() < ends_s:
            time.sleep(_LOOKS_S)


def _become(words: Sequence[str], folder: Path, environment: dict[str, str], output: int) -> NoReturn:
    status = 1
    try:
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        for stream in (1, 2):
            os.dup2(output, stream)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        sys.argv = list(words)
        _COMMANDS[words[0]]()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
