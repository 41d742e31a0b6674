"""A cache of build results that several processes may share.

An entry is a directory that appears at once, by a rename, when everything in it is complete. Its name is the
digest of all that decides about the result.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import time
from collections.abc import Awaitable, Callable, Iterable
from pathlib import Path

__all__ = ["BuildCache", "digest_of"]

_ABANDONED_AFTER_S = 3600.0


def digest_of(parts: Iterable[str]) -> str:
    """A name for what comes of these parts: other parts, another name."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()[:32]


class BuildCache:
    """Entries below a directory, which need not exist."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory

    def find(self, name: str) -> Path | None:
        """The entry of that name, if it is complete."""
        entry = self.directory / name
        return entry if entry.is_dir() else None

    async def fill(self, name: str, make: Callable[[Path], Awaitable[None]]) -> Path:
        """The entry of that name, which `make` fills if it is not there; what `make` raises leaves none."""
        entry = self.directory / name
        if entry.is_dir():
            return entry
        self._remove_abandoned()
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

    def _remove_abandoned(self) -> None:
        """Removes what builds left behind that were killed."""
        for path in self.directory.glob("*.building"):
            with contextlib.suppress(OSError):
                if time.time() - path.stat().st_mtime > _ABANDONED_AFTER_S:
                    shutil.rmtree(path, ignore_errors=True)
