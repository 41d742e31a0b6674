"""A folder that is watched for bundles dropped into it."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from pathlib import Path

from watchfiles import awatch

from aos_language.archive import is_archive_name
from aos_language.reading.files import is_document_name
from aos_protocol.errors import StorageError

_LONGEST_WAIT_S = 30.0

logging.getLogger("watchfiles").setLevel(logging.WARNING)


async def watch_for_bundles(
    folder: Path, take: Callable[[Path], Awaitable[None]], changed: asyncio.Queue[Path], *, quiet_s: float
) -> None:
    """Calls `take` with each sub-folder and archive in `folder`, one at a time, for ever.

    Documents that lie in `folder` itself are one bundle, for which `take` gets `folder`.

    First come those that are there, then each that has changed, and what else is put into `changed`. A bundle
    is taken once nothing changed for `quiet_s`, so that it is not read while it is being copied, and again
    after later changes. StorageError AOS701 for a folder that cannot be looked into.
    """
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(_follow(folder, changed, quiet_s))
        await asyncio.sleep(0)  # `_follow` has run to its first wait: the watch stands before the look.
        for path in bundles_in(folder):
            await take(path)
        while True:
            await take(await changed.get())


async def _follow(folder: Path, changed: asyncio.Queue[Path], quiet_s: float) -> None:
    step, debounce = int(quiet_s * 1000), int(_LONGEST_WAIT_S * 1000)
    try:
        async for batch in awatch(folder, step=step, debounce=debounce):
            touched = {_bundle_of(folder, Path(path)) for _, path in batch}
            for path in sorted(path for path in touched if path is not None and _is_bundle(path)):
                changed.put_nowait(path)
    except OSError as error:
        raise _unwatched(folder, error) from error


def bundles_in(folder: Path) -> list[Path]:
    """Returns what `take` is called with for a folder as it stands; StorageError AOS701 as above."""
    try:
        touched = {_bundle_of(folder, path) for path in folder.iterdir()}
    except OSError as error:
        raise _unwatched(folder, error) from error
    return sorted(path for path in touched if path is not None and _is_bundle(path))


def _unwatched(folder: Path, error: OSError) -> StorageError:
    text = f"the folder {folder} cannot be watched: {error.strerror or error}"
    return StorageError(text, hint="Name another one by `watch:`")


def _is_bundle(path: Path) -> bool:
    return path.is_dir() or (path.is_file() and is_archive_name(path.name))


def _bundle_of(folder: Path, path: Path) -> Path | None:
    """Returns what `take` is called with for a path that is there or has gone; None for hidden things."""
    parts = path.relative_to(folder).parts
    if not parts or any(part.startswith(".") for part in parts):
        return None
    is_document = len(parts) == 1 and is_document_name(parts[0]) and not path.is_dir()
    return folder if is_document else folder / parts[0]
