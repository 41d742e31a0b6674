"""The piece of document code that a child runs: memory that it writes, and that is read when it is gone."""

import struct

from aos_solver.child.process.shared_memory import SharedMemory

_BYTES = 65536
"""The largest page that blame.hpp maps; each of its threads has a line of 64 bytes in the first 4096."""


def new_blame_page() -> SharedMemory:
    """A page of a child that is yet to be started."""
    return SharedMemory.create("aos-blame", _BYTES)


def running_piece(page: SharedMemory) -> int:
    """The number of the piece that ran last; of several threads, the first one's. 0 where none did."""
    lines = struct.iter_unpack("=I60x", page.read(4096))
    return next((piece for (piece,) in lines if piece != 0), 0)
