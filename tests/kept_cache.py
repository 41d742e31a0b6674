"""The folder in which compiled models are kept from one run of the tests to the next."""

from __future__ import annotations

import contextlib
import shutil
from pathlib import Path

__all__ = ["link_engines", "make_room"]


def link_engines(folder: Path, cache: Path) -> None:
    """Makes the engines that are in a folder entries of a cache, too.

    An entry's name says what it was made from: engines of other sources are not found by it.
    """
    cache.mkdir(exist_ok=True)
    for engine in folder.glob("engine-*-*"):
        if engine.suffix not in (".building", ".lock"):
            with contextlib.suppress(FileExistsError):
                (cache / engine.name).symlink_to(engine)


def make_room(cache: Path, limit_bytes: int) -> None:
    """Removes links to engines that are gone, and the entries unused for longest beyond so many bytes."""
    entries = list(cache.glob("*-*"))
    for link in entries:
        if link.is_symlink() and not link.exists():
            link.unlink(missing_ok=True)
    kept_bytes = 0
    for entry in sorted(filter(_is_own, entries), key=lambda path: path.stat().st_mtime, reverse=True):
        kept_bytes += sum(file.stat().st_size for file in entry.rglob("*") if file.is_file())
        if kept_bytes > limit_bytes:
            shutil.rmtree(entry, ignore_errors=True)


def _is_own(entry: Path) -> bool:
    return entry.is_dir() and not entry.is_symlink()
