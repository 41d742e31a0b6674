"""One process makes a thing, the others wait for it: a lock between processes that share a directory.

The kernel holds the lock for an open file (`flock`) and lets go of it when the process that opened it ends,
however it ends: nobody has to find out whether an owner lives. One that lives and does not get on is waited
for until a deadline. Where the file system has no locks, nobody waits.
"""

import asyncio
import errno
import fcntl
import os
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

_LOOK_EVERY_S = 0.1


@asynccontextmanager
async def build_lock(path: Path, patience_s: float, on_wait: Callable[[], None]) -> AsyncIterator[None]:
    """Holds the lock file `path` within the block; goes on without it when `patience_s` are over.

    `on_wait` is called once if somebody else holds it. The file is there only while somebody holds the lock.
    """
    until_s = time.monotonic() + patience_s
    handle = _held(path)
    if handle is None and patience_s > 0:
        on_wait()
    while handle is None and time.monotonic() < until_s:
        await asyncio.sleep(_LOOK_EVERY_S)
        handle = _held(path)
    try:
        yield
    finally:
        if handle is not None and handle != _NO_LOCKS:
            _let_go(path, handle)


_NO_LOCKS = -1


def _held(path: Path) -> int | None:
    """The open file that holds the lock; None while another holds it, `_NO_LOCKS` where there are none."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    try:
        if locked(handle, path, fcntl.LOCK_EX):
            return handle
    except OSError as error:
        os.close(handle)
        if error.errno in (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS):
            return _NO_LOCKS
        raise
    return None


def locked(handle: int, path: Path, kind: int) -> bool:
    """Takes the lock of an open file; closes it where another holds that, or what `path` names has changed.

    OSError where there are no locks.
    """
    try:
        fcntl.flock(handle, kind | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(handle), path.stat()):
            return True
    except (BlockingIOError, FileNotFoundError):
        pass  # Its last holder may just have taken it away.
    os.close(handle)
    return False


def _let_go(path: Path, handle: int) -> None:
    with suppress(OSError):
        path.unlink()  # While it is held: whoever has opened this file already finds that it is gone.
    os.close(handle)
