"""Paths that files name: what stands there, also of names that no file system takes and links in a circle."""

import os
from collections.abc import Callable
from pathlib import Path

_LONGEST = 200


def is_there(path: Path) -> bool:
    """Returns whether there is anything; False where there cannot be."""
    return _holds(path.exists)


def is_file(path: Path) -> bool:
    """Returns whether there is a file; False where there cannot be one."""
    return _holds(path.is_file)


def is_folder(path: Path) -> bool:
    """Returns whether there is a folder; False where there cannot be one."""
    return _holds(path.is_dir)


def _holds(of_path: Callable[[], bool]) -> bool:
    try:
        return of_path()
    except OSError:
        return False


def absolute(path: Path) -> Path:
    """The whole path without links; of a link in a circle the path to it."""
    return Path(os.path.realpath(path))


def named(path: Path) -> str:
    """The path as a message names it, of a very long one the beginning."""
    text = str(path)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
