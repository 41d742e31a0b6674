"""Locks of folders, each of which goes with the process that holds it."""

import fcntl
import os
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
