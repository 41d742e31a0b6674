"""Files of which nobody ever reads a part."""

import os
from collections.abc import Callable
from pathlib import Path

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
