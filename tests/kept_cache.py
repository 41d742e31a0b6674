"""The folder in which compiled models are kept from one run of the tests to the next."""

from __future__ import annotations

import contextlib
from pathlib import Path

__all__ = ["link_engines"]


def link_engines(folder: Path, cache: Path) -> None:
    """Makes the engines that are in a folder entries of a cache, too.

    An entry's name says what it was made from: engines of other sources are not found by it. The cache itself
    removes what is unused for long, and holds its size (aos_solver.building.build_cache).
    """
    cache.mkdir(exist_ok=True)
    for link in cache.glob("engine-*-*"):
        if link.is_symlink() and not link.exists():
            link.unlink(missing_ok=True)
    for engine in folder.glob("engine-*-*"):
        if engine.suffix not in (".building", ".lock"):
            with contextlib.suppress(FileExistsError):
                (cache / engine.name).symlink_to(engine)
