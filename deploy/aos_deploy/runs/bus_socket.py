"""The place of the bus: a Unix socket that only the user of the run can reach."""

import fcntl
import os
import re
import socket as sockets
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from aos_runtime.disk.folder_lock import locked_folder

SOCKET = "bus"
"""The name of the socket in the run directory."""

_LONGEST_BYTES = 107
"""The kernel takes no longer path of a socket."""
_PLAIN = re.compile(r"/[A-Za-z0-9_./@+,=~-]+")
"""Zenoh reads other characters of an endpoint as the beginning of options."""
_PREFIX = "aos-bus-"
_KEPT: dict[Path, int] = {}
"""Locks of the folders that this process has made, which end with it, also by SIGKILL."""


def place_of_socket(run: Path) -> Path:
    """The socket's path: in the run directory, or where that cannot be one, in a short folder of its own.

    OSError if no folder for it can be made.
    """
    inside = run / SOCKET
    if _can_be(inside):
        return inside
    remove_left_sockets()
    for folder in _folders():
        name = folder / f"{_PREFIX}12345678" / SOCKET
        if _can_be(name) and os.access(folder, os.W_OK | os.X_OK):
            return _made_in(folder) / SOCKET
    raise OSError(36, f"no folder has a path that is short enough for the socket of {run}")


def _made_in(folder: Path) -> Path:
    """A new folder whose lock this process holds, where there are locks."""
    while True:
        made = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder))
        lock = _locked(made, waits=True)
        if lock is not None:
            _KEPT[made] = lock
        if made.exists():  # Before it was locked, another process may have removed it as left.
            return made
        remove_socket(made / SOCKET)


def remove_socket(socket: Path) -> None:
    """Removes what a router has left that was killed, and the folder if it is the socket's own."""
    for path in (socket, socket.with_name(f"{socket.name}.lock")):
        with suppress(OSError):
            path.unlink()
    if socket.parent.name.startswith(_PREFIX):
        with suppress(OSError):
            socket.parent.rmdir()
        if (lock := _KEPT.pop(socket.parent, None)) is not None:
            os.close(lock)


def remove_left_sockets() -> None:
    """Removes the folders of sockets whose `aos-up` was killed."""
    for folder in _folders():
        with suppress(OSError):
            for left in folder.glob(f"{_PREFIX}*"):
                _remove_if_left(left)


def _remove_if_left(folder: Path) -> None:
    if folder.lstat().st_uid != os.getuid():
        return
    lock = _locked(folder)
    if lock is None:
        return
    try:
        if not _is_listened_at(folder / SOCKET):
            remove_socket(folder / SOCKET)
    finally:
        os.close(lock)


def _folders() -> Iterator[Path]:
    """The folders in which a socket's own folder may be, the first ones first."""
    named = (os.environ.get("XDG_RUNTIME_DIR", ""), tempfile.gettempdir(), "/tmp")
    yield from dict.fromkeys(Path(name) for name in named if name)


def _locked(folder: Path, *, waits: bool = False) -> int | None:
    """A descriptor that holds the folder's lock; None where somebody else does, or it is no folder.

    Whoever looks whether a folder was left holds it for a second at most, and can be waited for.
    """
    kind = fcntl.LOCK_EX | (0 if waits else fcntl.LOCK_NB)
    try:
        return locked_folder(folder, kind, opened=os.O_NOFOLLOW)
    except OSError:
        return None


def _is_listened_at(path: Path) -> bool:
    """Says whether a router is there, of an `aos-up` that takes no lock."""
    with sockets.socket(sockets.AF_UNIX) as client:
        client.settimeout(1.0)
        try:
            client.connect(str(path))
        except (FileNotFoundError, ConnectionRefusedError):
            return False
        except OSError:
            return True
    return True


def _can_be(socket: Path) -> bool:
    text = str(socket)
    return len(os.fsencode(text)) <= _LONGEST_BYTES and _PLAIN.fullmatch(text) is not None
