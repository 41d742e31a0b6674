import contextlib
import os
from pathlib import Path

from aos_deploy.places import cache_dir as user_cache_dir

_CACHE = Path(os.environ.get("AOS_TEST_CACHE", Path(__file__).resolve().parents[1] / ".compiled"))
"""The checkout may be another user's."""


def kept_cache() -> Path:
    """The folder, with the engines that set-up has compiled."""
    link_engines(user_cache_dir(), _CACHE)
    return _CACHE


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
