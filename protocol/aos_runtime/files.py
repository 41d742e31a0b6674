"""Locks of folders, which go with the process that holds them, and files that nobody reads a part of."""

import fcntl
import os
from collections.abc import Callable
from pathlib import Path


def locked_folder(folder: Path, kind: int, *, opened: int = 0) -> int:
    """Returns a descriptor that holds the lock; OSError where another excludes it, or it is no folder."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC | opened)
    try:
        fcntl.flock(handle, kind)
    except OSError:
        os.close(handle)
        raise
    return handle


PRIVATE = 0o600


def write_whole(
    path: Path, content: bytes, *, mode: int = 0o666, before_rename: Callable[[], None] | None = None
) -> None:
    """Writes beside the file and renames. The mode is that of a new file, before the process's mask.

    OSError where it cannot be written: then the file is as it was, and nothing lies beside it.
    """
    beside = path.with_name(f".{path.name}-{os.getpid()}")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, mode), "wb") as file:
            file.write(content)
        if before_rename is not None:
            before_rename()
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
