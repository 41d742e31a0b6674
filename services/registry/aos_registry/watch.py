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
    """Calls `take` with each sub-folder, archive and document in `folder`, one at a time, for ever.

    First come those that are there, then each that has changed, and what else is put into `changed`. A bundle
    is taken once nothing changed for `quiet_s`, so that it is not read while it is being copied, and again
    after later changes. StorageError AOS701 for a folder that cannot be looked into.
    """
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(_follow(folder, changed, quiet_s))
        await asyncio.sleep(0)  # `_follow` has run to its first wait: the watch stands before the look.
        for path in _bundles_in(folder):
            await take(path)
        while True:
            await take(await changed.get())


async def _follow(folder: Path, changed: asyncio.Queue[Path], quiet_s: float) -> None:
    step, debounce = int(quiet_s * 1000), int(_LONGEST_WAIT_S * 1000)
    try:
        async for batch in awatch(folder, step=step, debounce=debounce):
            touched = {_bundle_of(folder, Path(path)) for _, path in batch}
            for path in sorted(path for path in touched if path is not None and _may_be_bundle(path)):
                changed.put_nowait(path)
    except OSError as error:
        raise _unwatched(folder, error) from error


def _bundles_in(folder: Path) -> list[Path]:
    try:
        inside = [path for path in folder.iterdir() if not path.name.startswith(".")]
    except OSError as error:
        raise _unwatched(folder, error) from error
    return sorted(path for path in inside if _may_be_bundle(path))


def _unwatched(folder: Path, error: OSError) -> StorageError:
    text = f"the folder {folder} cannot be watched: {error.strerror or error}"
    return StorageError(text, hint="Name another one by `watch:`")


def _may_be_bundle(path: Path) -> bool:
    return path.is_dir() or is_document(path) or (path.is_file() and is_archive_name(path.name))


def is_document(path: Path) -> bool:
    """Returns whether this is a document alone, which is no bundle."""
    return is_document_name(path.name) and path.is_file()


def _bundle_of(folder: Path, path: Path) -> Path | None:
    """The sub-folder or file that a changed path belongs to; None for hidden things and the folder."""
    parts = path.relative_to(folder).parts
    if not parts or any(part.startswith(".") for part in parts):
        return None
    return folder / parts[0]
