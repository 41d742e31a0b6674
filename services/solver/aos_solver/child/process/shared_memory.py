"""Memory that a child process writes and its parent keeps when the child is gone, such as its blame page."""

import os
import struct
from typing import Self


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
    def descriptor(self) -> int:
        """The number of the descriptor, for a child to which it is passed."""
        return self._file

    def read(self, size_bytes: int, place: int = 0) -> bytes:
        """Returns what is in it from a place on, by default from its beginning."""
        return os.pread(self._file, size_bytes, place)

    def take(self, size_bytes: int) -> tuple[bytes, bytes]:
        """Returns so much of what is in it, and the rest; then it is empty."""
        with os.fdopen(os.dup(self._file), "rb") as file:
            file.seek(0)
            taken = file.read(size_bytes), file.read()
        os.truncate(self._file, 0)
        return taken

    def close(self) -> None:
        """Gives the memory back once no child has it."""
        os.close(self._file)


_BYTES = 65536
"""The largest page that blame.hpp maps; each of its threads has a line of 64 bytes in the first 4096."""


def new_blame_page() -> SharedMemory:
    """A page of a child that is yet to be started."""
    return SharedMemory.create("aos-blame", _BYTES)


def running_piece(page: SharedMemory) -> int:
    """The number of the piece that ran last; of several threads, the first one's. 0 where none did."""
    lines = struct.iter_unpack("=I60x", page.read(4096))
    return next((piece for (piece,) in lines if piece != 0), 0)
