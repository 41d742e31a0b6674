"""A cache of build results that several processes may share.

An entry is a directory that appears at once, by a rename, when everything in it is complete. Its name is the
digest of all that decides about the result. Before a new entry is made, those beyond the cache's size go that
were not asked for the longest. No age counts, since clocks are set: whoever uses a folder holds its lock, and
what is asked for gets a later stamp than all others have.

Who makes an entry holds its lock (`build_lock`), and others wait for the entry instead of making it as well.
The kernel holds it for an open file (`flock`) and lets go of it when the process that opened it ends, however
it ends: nobody has to find out whether an owner lives. One that lives and does not get on is waited for until
a deadline. Where the file system has no locks, nobody waits.
"""

import asyncio
import errno
import fcntl
import hashlib
import os
import shutil
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from aos_protocol.errors import StorageError
from aos_runtime.disk.folder_lock import locked_folder

_BUILDING = ".building"
_SIZE_BYTES = 2 * 2**30
"""A dozen engines with headers compiled in advance, of some 100 MB each, and hundreds of models of 1 MB."""
_USED: dict[tuple[int, int], int] = {}
"""The folders that this process has asked for last, each with the open file that holds its lock."""
_MOST_USED = 64
"""A process may have few files: beyond so many it lets go of the first."""


def digest_of(parts: Iterable[str]) -> str:
    """A name for what comes of these parts: other parts, another name."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()[:32]


class BuildCache:
    """Entries below a directory, which need not exist."""

    def __init__(self, directory: Path, size_bytes: int = _SIZE_BYTES) -> None:
        self.directory = directory.absolute()
        self._size_bytes = size_bytes

    def find(self, name: str) -> Path | None:
        """The entry of that name, if it is complete and can be opened."""
        entry = self.directory / name
        try:
            handle = _held(entry)
        except OSError:
            return None
        if handle is None:
            return None
        status = os.fstat(handle)
        if (older := _USED.pop((status.st_dev, status.st_ino), None)) is not None:
            os.close(older)
        _USED[status.st_dev, status.st_ino] = handle
        while len(_USED) > _MOST_USED:
            os.close(_USED.pop(next(iter(_USED))))
        with suppress(OSError):
            newest_ns = max(path.lstat().st_mtime_ns for path in self.directory.glob("*-*"))
            os.utime(entry, ns=(max(time.time_ns(), newest_ns + 1),) * 2)
        return entry

    async def fill(
        self,
        name: str,
        make: Callable[[Path], Awaitable[None]],
        *,
        patience_s: float = 0.0,
        on_wait: Callable[[], None] = lambda: None,
    ) -> Path:
        """The entry of that name, which `make` fills if it is not there; what `make` raises leaves none.

        While another process makes it, this one waits for up to `patience_s`, and says so with `on_wait`. If
        the other one ends without the entry, or takes longer, it is made here. StorageError AOS701 where the
        cache cannot be written.
        """
        if (found := self.find(name)) is not None:
            return found
        self._remove_old()
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            async with build_lock(self.directory / f"{name}.lock", patience_s, on_wait):
                if (found := self.find(name)) is not None:
                    return found
                return await self._made(name, make)
        except OSError as error:
            raise StorageError(
                f"the cache {self.directory} cannot be written: {error.strerror}",
                hint="$AOS_CACHE_DIR names another folder for compiled models",
            ) from error

    async def _made(self, name: str, make: Callable[[Path], Awaitable[None]]) -> Path:
        entry = self.directory / name
        staging = self.directory / f"{name}.{os.getpid()}.{time.monotonic_ns()}{_BUILDING}"
        handle = None
        while handle is None:  # Another process may remove it before it is held.
            staging.mkdir(parents=True, exist_ok=True)
            handle = _held(staging)
        try:
            await make(staging)
            self._move_into_place(staging, entry)
        finally:
            shutil.rmtree(staging, ignore_errors=True)
            os.close(handle)
        return self.find(name) or entry

    def _move_into_place(self, staging: Path, entry: Path) -> None:
        try:
            staging.rename(entry)
        except OSError:
            # Another process was quicker with the same.
            if not entry.is_dir():
                raise

    def _remove_old(self) -> None:
        """Removes what killed builds have left, and what is beyond the size of the cache."""
        kept: list[tuple[int, Path]] = []
        for path in self.directory.glob("*-*"):
            with suppress(OSError):
                if path.is_symlink() or not path.is_dir():
                    continue
                if path.suffix == _BUILDING:
                    _remove(path)
                else:
                    kept.append((path.stat().st_mtime_ns, path))
        excess_bytes = sum(_size_bytes(path) for _, path in kept) - self._size_bytes
        for _, path in sorted(kept):
            if excess_bytes <= 0:
                return
            size_bytes = _size_bytes(path)
            if _remove(path):
                excess_bytes -= size_bytes


def _held(folder: Path) -> int | None:
    """An open file that holds a folder's lock beside others; None where it is not there, or being removed.

    OSError where it cannot be opened.
    """
    try:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except (FileNotFoundError, NotADirectoryError):
        return None
    try:
        return handle if locked(handle, folder, fcntl.LOCK_SH) else None
    except OSError:
        return handle  # Where there are no locks, nobody removes anything.


def _remove(folder: Path) -> bool:
    """Removes a folder that nobody holds; returns whether it has gone."""
    try:
        handle = locked_folder(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    try:
        if folder.suffix != _BUILDING:
            # It goes at once, as it came.
            folder = folder.rename(f"{folder}.{os.getpid()}.{time.monotonic_ns()}{_BUILDING}")
        shutil.rmtree(folder, ignore_errors=True)
    except OSError:
        return False
    finally:
        os.close(handle)
    return True


def _size_bytes(folder: Path) -> int:
    """The space that a folder takes with all below it, as far as it is still there."""
    size_bytes = 0
    for parent, _, names in os.walk(folder):  # What has just gone is left out.
        for name in names:
            with suppress(OSError):
                size_bytes += Path(parent, name).lstat().st_blocks * 512
    return size_bytes


_LOOK_EVERY_S = 0.1


@asynccontextmanager
async def build_lock(path: Path, patience_s: float, on_wait: Callable[[], None]) -> AsyncIterator[None]:
    """Holds the lock file `path` within the block; goes on without it when `patience_s` are over.

    `on_wait` is called once if somebody else holds it. The file is there only while somebody holds the lock.
    """
    until_s = time.monotonic() + patience_s
    handle = _locked(path)
    if handle is None and patience_s > 0:
        on_wait()
    while handle is None and time.monotonic() < until_s:
        await asyncio.sleep(_LOOK_EVERY_S)
        handle = _locked(path)
    try:
        yield
    finally:
        if handle is not None and handle != _NO_LOCKS:
            _let_go(path, handle)


_NO_LOCKS = -1


def _locked(path: Path) -> int | None:
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
