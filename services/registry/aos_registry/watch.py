"""A folder that is watched for bundles dropped into it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from pathlib import Path

from watchfiles import awatch

__all__ = ["watch_for_bundles"]

_LONGEST_WAIT_S = 30.0

logging.getLogger("watchfiles").setLevel(logging.WARNING)


async def watch_for_bundles(folder: Path, take: Callable[[Path], Awaitable[None]], *, quiet_s: float) -> None:
    """Calls `take` with each sub-folder of `folder`, one at a time, until it is cancelled.

    First come those that are there, then each that has changed. A folder is taken once nothing changed for
    `quiet_s`, so that it is not read while it is being copied, and again after later changes.
    """
    changed: asyncio.Queue[Path] = asyncio.Queue()
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(_follow(folder, changed, quiet_s))
        await asyncio.sleep(0)  # `_follow` has run to its first wait: the watch stands before the look.
        for path in _folders_in(folder):
            await take(path)
        while True:
            await take(await changed.get())


async def _follow(folder: Path, changed: asyncio.Queue[Path], quiet_s: float) -> None:
    step, debounce = int(quiet_s * 1000), int(_LONGEST_WAIT_S * 1000)
    async for batch in awatch(folder, step=step, debounce=debounce):
        touched = {_bundle_of(folder, Path(path)) for _, path in batch}
        for path in sorted(path for path in touched if path is not None and path.is_dir()):
            changed.put_nowait(path)


def _folders_in(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.is_dir() and not path.name.startswith("."))


def _bundle_of(folder: Path, path: Path) -> Path | None:
    """The sub-folder that a changed path lies in; None for what is hidden and for the folder itself."""
    parts = path.relative_to(folder).parts
    if not parts or any(part.startswith(".") for part in parts):
        return None
    return folder / parts[0]
