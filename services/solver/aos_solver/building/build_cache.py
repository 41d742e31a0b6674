"""A cache of build results that several processes may share.

An entry is a directory that appears at once, by a rename, when everything in it is complete. Its name is the
digest of all that decides about the result. Before a new entry is made, those go that nobody has asked for in
a month, and beyond the cache's size those that were not asked for the longest.

Who makes an entry holds its lock (`build_lock`), and others wait for the entry instead of making it as well.
"""

import contextlib
import hashlib
import os
import shutil
import time
from collections.abc import Awaitable, Callable, Iterable
from pathlib import Path

from aos_protocol.errors import StorageError
from aos_solver.building.build_lock import build_lock

_ABANDONED_AFTER_S = 3600.0
_UNUSED_AFTER_S = 30 * 86400.0
_SIZE_BYTES = 2 * 2**30
"""A dozen engines with headers compiled in advance, of some 100 MB each, and hundreds of models of 1 MB."""
_IN_USE_S = 3600.0
"""An entry that somebody has asked for within this time may be in use, and stays whatever the size of all."""


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
        """The entry of that name, if it is complete."""
        entry = self.directory / name
        if not entry.is_dir():
            return None
        with contextlib.suppress(OSError):
            os.utime(entry)
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
        staging = self.directory / f"{name}.{os.getpid()}.{time.monotonic_ns()}.building"
        staging.mkdir(parents=True)
        try:
            await make(staging)
            self._move_into_place(staging, entry)
        finally:
            shutil.rmtree(staging, ignore_errors=True)
        return entry

    def _move_into_place(self, staging: Path, entry: Path) -> None:
        try:
            staging.rename(entry)
        except OSError:
            # Another process was quicker with the same.
            if not entry.is_dir():
                raise

    def _remove_old(self) -> None:
        """Removes unused entries, what killed builds have left, and what is beyond the size of the cache."""
        now_s = time.time()
        kept: list[tuple[float, Path]] = []
        for path in self.directory.glob("*-*"):
            limit_s = _ABANDONED_AFTER_S if path.suffix == ".building" else _UNUSED_AFTER_S
            with contextlib.suppress(OSError):
                if path.is_symlink() or not path.is_dir():
                    continue
                asked_s = path.stat().st_mtime
                if now_s - asked_s > limit_s:
                    shutil.rmtree(path, ignore_errors=True)
                else:
                    kept.append((asked_s, path))
        excess_bytes = sum(_size_bytes(path) for _, path in kept) - self._size_bytes
        for asked_s, path in sorted(kept):
            if excess_bytes <= 0 or now_s - asked_s < _IN_USE_S:
                return
            excess_bytes -= _size_bytes(path)
            shutil.rmtree(path, ignore_errors=True)


def _size_bytes(folder: Path) -> int:
    """The space that a folder takes with all below it, as far as it is still there."""
    size_bytes = 0
    for parent, _, names in os.walk(folder):  # What has just gone is left out.
        for name in names:
            with contextlib.suppress(OSError):
                size_bytes += Path(parent, name).lstat().st_blocks * 512
    return size_bytes
