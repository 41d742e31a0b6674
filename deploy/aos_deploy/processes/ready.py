"""The wait until a program of the user's own is ready, as the deploy file says it is seen."""

import asyncio
import os
import re
from pathlib import Path
from typing import NamedTuple

from aos_deploy.deployment.own_programs import ReadyPart
from aos_deploy.processes.program import words_of
from aos_protocol.errors import DeployError
from aos_runtime.processes.children import Child, guarded

_LOOK_EVERY_S = 0.1
_CONNECT_S = 2.0
_COMMAND_S = 10.0


class Before(NamedTuple):
    """The surroundings of a program just before its start: the length of its log, its file of `ready`."""

    log_size: int
    file: tuple[int, ...]


def before_start(ready: ReadyPart | None, log: Path, folder: Path) -> Before:
    """The surroundings now."""
    size = log.stat().st_size if log.exists() else 0
    return Before(size, _mark(folder / ready.file) if ready is not None and ready.file is not None else ())


async def until_seen_ready(ready: ReadyPart, log: Path, before: Before, folder: Path) -> None:
    """Returns when it is as `ready` says, counted from `before`. What the program prints is in `log`.

    Paths are relative to `folder`, where commands run, too. An exit is not awaited here.
    """
    printed = _Printed(log, before.log_size, ready.line or "")
    if ready.seconds is not None:
        await asyncio.sleep(ready.seconds)
        return
    while True:
        if ready.port is not None and await _is_served(ready.address, ready.port):
            return
        if ready.line is not None and printed.has_line():
            return
        if ready.file is not None and _was_written(folder / ready.file, before.file):
            return
        if ready.command and await _succeeds(ready.command, folder):
            return
        await asyncio.sleep(_LOOK_EVERY_S)


async def check_port_is_free(name: str, ready: ReadyPart | None) -> None:
    """Raises DeployError AOS802 if somebody else serves the port by which the program is to be seen."""
    if ready is not None and ready.port is not None and await _is_served(ready.address, ready.port):
        where = f"{ready.address}:{ready.port}"
        raise DeployError(
            f"{name} is to serve {where}, where something listens before it is started",
            code="AOS802",
            hint=f"Stop what is left of an earlier run (`ss -ltnp 'sport = :{ready.port}'` names it), "
            f"or say in another way when {name} is ready",
        )


class _Printed:
    """The lines that are added to a log; the last one may be unfinished."""

    def __init__(self, log: Path, start: int, pattern: str) -> None:
        self._log = log
        self._position = start
        self._pattern = re.compile(pattern)
        self._rest = ""

    def has_line(self) -> bool:
        """Returns whether one of the lines since the last question matches."""
        with self._log.open("rb") as log:
            if log.seek(0, os.SEEK_END) < self._position:
                self._position = 0  # It was so long that it was cut.
            log.seek(self._position)
            new = log.read()
            self._position = log.tell()
        lines = (self._rest + new.decode(errors="replace")).split("\n")
        self._rest = lines[-1]
        return any(self._pattern.search(line) for line in lines)


def _was_written(path: Path, before: tuple[int, ...]) -> bool:
    """Returns whether a file was made or written since; a device that is there counts as it is."""
    mark = _mark(path)
    return bool(mark) and (mark != before or path.is_char_device() or path.is_block_device())


def _mark(path: Path) -> tuple[int, ...]:
    """The file as it is now, empty where there is none.

    That it was written is seen by a change alone: the clock may have been set meanwhile.
    """
    try:
        found = path.stat()
    except OSError:
        return ()
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


async def _is_served(address: str, port: int) -> bool:
    try:
        async with asyncio.timeout(_CONNECT_S):
            _, writer = await asyncio.open_connection(address, port)
    except (OSError, TimeoutError):
        return False
    writer.close()
    return True


async def _succeeds(command: tuple[str, ...], folder: Path) -> bool:
    child = await Child.start(
        guarded(words_of(command)),
        cwd=folder,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.DEVNULL,
    )
    try:
        return await child.wait_for(_COMMAND_S) and child.returncode == 0
    finally:
        await child.stop()
