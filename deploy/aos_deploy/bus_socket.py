"""The place of the bus: a Unix socket that only the user of the run can reach."""

from __future__ import annotations

import os
import re
import tempfile
from contextlib import suppress
from pathlib import Path

__all__ = ["SOCKET", "place_of_socket", "remove_socket"]

SOCKET = "bus"
"""The name of the socket in the run directory."""

_LONGEST_BYTES = 107
"""The kernel takes no longer path of a socket."""
_PLAIN = re.compile(r"/[A-Za-z0-9_./@+,=~-]+")
"""Zenoh reads other characters of an endpoint as the beginning of options."""
_PREFIX = "aos-bus-"


def place_of_socket(run: Path) -> Path:
    """The socket's path: in the run directory, or where that cannot be one, in a short folder of its own.

    OSError if no folder for it can be made.
    """
    inside = run / SOCKET
    if _can_be(inside):
        return inside
    for folder in (os.environ.get("XDG_RUNTIME_DIR", ""), tempfile.gettempdir(), "/tmp"):
        name = Path(folder) / f"{_PREFIX}12345678" / SOCKET
        if folder and _can_be(name) and os.access(folder, os.W_OK | os.X_OK):
            return Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder)) / SOCKET
    raise OSError(36, f"no folder has a path that is short enough for the socket of {run}")


def remove_socket(socket: Path) -> None:
    """Removes what a router has left that was killed, and the folder if it is the socket's own."""
    for path in (socket, socket.with_name(f"{socket.name}.lock")):
        with suppress(OSError):
            path.unlink()
    if socket.parent.name.startswith(_PREFIX):
        with suppress(OSError):
            socket.parent.rmdir()


def _can_be(socket: Path) -> bool:
    text = str(socket)
    return len(os.fsencode(text)) <= _LONGEST_BYTES and _PLAIN.fullmatch(text) is not None
