"""Memory that a child process writes and its parent keeps when the child is gone."""

from __future__ import annotations

import os
from typing import Self

__all__ = ["SharedMemory"]


class SharedMemory:
    """A file in memory alone, so that nothing is left behind however we end; close it after use."""

    def __init__(self, file: int) -> None:
        self._file = file

    @classmethod
    def create(cls, name: str, size_bytes: int = 0) -> Self:
        """Zeros; a child may write beyond their end."""
        file = os.memfd_create(name)
        os.truncate(file, size_bytes)
        return cls(file)

    @property
    def path(self) -> str:
        """The path at which a child can open it, through us."""
        return f"/proc/{os.getpid()}/fd/{self._file}"

    def read(self, size_bytes: int) -> bytes:
        """Returns what is in it from its beginning."""
        return os.pread(self._file, size_bytes, 0)

    def close(self) -> None:
        """Gives the memory back once no child has it."""
        os.close(self._file)
