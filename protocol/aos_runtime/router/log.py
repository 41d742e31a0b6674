"""The refusals of the router, as lines of its log: Zenoh itself denies in silence, and tells its trace alone.

The trace goes to standard output, which nothing else of the router writes to. A flood of one kind of refusal
is counted, and told each time that it has grown tenfold.
"""

from __future__ import annotations

import fcntl
import logging
import os
import re
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from aos_runtime.bus.recurring import Recurring

_TRACE = (
    "error,zenoh::net::routing::interceptor=trace,zenoh::net::routing::interceptor::access_control=trace,"
    "zenoh_transport::unicast::establishment::accept=debug"
)
_THREAD = re.compile(rb"ThreadId\((\d+)\)")
_DENIED = re.compile(
    rb"(?P<session>[0-9a-f]+) (?:on Username\((?P<user>[^)]*)\)\S* )?is unauthorized to (?P<what>.+?) "
    rb"\(ingress\) on (?P<key>\S+)"
)
_IS_OVER = b"Msg intercepted!"
_CONNECTIONS = {
    b"Expected extension": "refused: a connection without a name",
    b"Invalid user": "refused: a connection with an unknown name",
    b"Invalid password": "refused: a connection with a wrong password",
}
_SESSIONS = 1000
"""So many sessions are known by their names."""
_PIPE_BYTES = 1 << 20
_LOOKS_S = 0.02
"""The trace is read so often, and not at once: who waits for it would be woken by every message."""

_log = logging.getLogger("aos.router")


@contextmanager
def refusals_logged(trace: Callable[[str], None]) -> Iterator[None]:
    """Refusals come into the log until the block ends. `trace` starts Zenoh's trace at given levels."""
    reading, writing = os.pipe()
    with suppress(OSError):
        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)
    before = os.dup(1)
    os.dup2(writing, 1)
    os.close(writing)
    thread = threading.Thread(target=_read, args=(reading, RefusalLog(_log.warning)), daemon=True)
    thread.start()
    os.environ.pop("RUST_LOG", None)
    os.environ["NO_COLOR"] = "1"
    trace(_TRACE)
    try:
        yield
    finally:
        os.dup2(before, 1)  # The pipe has no writer any more, so that the thread ends.
        os.close(before)
        thread.join(1.0)


class RefusalLog:
    """Takes lines of Zenoh's trace, and tells what of them is worth a line."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._refusals = Recurring(tell)
        self._users: dict[bytes, str] = {}
        self._denied: dict[bytes, str] = {}

    def take(self, line: bytes) -> None:
        """One line: a refusal is told when it is new, and when there were 10, 100, 1000 of it.

        What is denied is a refusal when its thread says that the message goes no further; before that it may
        be a permission that is looked up for later.
        """
        if _IS_OVER in line:
            self._count(self._denied.pop(_thread(line), ""))
        elif b"unauthorized to" in line:
            self._note(line)
        elif b"UsrPwd" in line:
            self._count(next((text for sign, text in _CONNECTIONS.items() if sign in line), ""))

    def _count(self, text: str) -> None:
        if text:
            self._refusals.count(text)

    def _note(self, line: bytes) -> None:
        thread, denied = _thread(line), _DENIED.search(line)
        self._denied.pop(thread, None)
        if denied is None:
            return
        session = denied["session"]
        if denied["user"] is not None:
            if len(self._users) >= _SESSIONS:
                self._users.clear()
            self._users[session] = denied["user"].decode()
        who = self._users.get(session, "somebody")
        what, key = denied["what"].decode().lower(), denied["key"].decode(errors="replace")
        self._denied[thread] = f"refused: {who} may not send {what} on {key}"


def _thread(line: bytes) -> bytes:
    found = _THREAD.search(line)
    return found[1] if found else b""


def _read(reading: int, log: RefusalLog) -> None:
    rest = b""
    pause = threading.Event()
    while chunk := os.read(reading, _PIPE_BYTES):
        *lines, rest = (rest + chunk).split(b"\n")
        for line in lines:
            log.take(line)
        pause.wait(_LOOKS_S)
    os.close(reading)
