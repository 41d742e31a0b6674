"""Connects to an SSH server and hands the connection to the ssh that started this file (`ProxyUseFdpass`).

    python -I -S ssh_connection.py HOST PORT

ssh itself waits up to two seconds between attempts, and sends its small messages by Nagle's rule: each one
waits for the receipt of the one before it. Here an attempt begins three times a second, also where the host
refuses it, no message waits, and a connection that is lost is told earlier. The file imports the standard
library alone, so that it starts at once.
"""

import errno
import os
import select
import socket
import sys
import time
from typing import Any

_EVERY_S = 0.3
_ATTEMPT_S = 3.0
_LOST_MS = 3200
"""A connection is lost when something that was sent is not received for so long. TCP tries again after 0.2,
0.6, 1.4 and 3 s, and then waits for longer than a new connection takes."""
_FOR_S = 12.0
"""The time for all attempts together; then ssh ends, and its end is told."""


def connected(host: str, port: str, for_s: float = _FOR_S) -> socket.socket:
    """Returns the first connection that comes about; OSError of the last attempt if none does in time."""
    ends_s = time.monotonic() + for_s
    attempts: dict[socket.socket, float] = {}
    error: OSError = TimeoutError(errno.ETIMEDOUT, os.strerror(errno.ETIMEDOUT))
    number = 0
    try:
        while (now_s := time.monotonic()) < ends_s:
            for attempt in [one for one, since_s in attempts.items() if now_s - since_s > _ATTEMPT_S]:
                attempts.pop(attempt)
                attempt.close()
            try:
                addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
                attempts[_begun(addresses[number % len(addresses)])] = now_s
            except OSError as failure:
                error = failure
            number += 1
            while (left_s := now_s + _EVERY_S - time.monotonic()) > 0:
                for attempt in select.select([], list(attempts), [], left_s)[1]:
                    attempts.pop(attempt)
                    status = attempt.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
                    if status == 0:
                        attempt.setblocking(True)
                        return attempt
                    error = OSError(status, os.strerror(status))
                    attempt.close()
    finally:
        for attempt in attempts:
            attempt.close()
    raise error


def _begun(address: tuple[Any, ...]) -> socket.socket:
    """A connection that is about to be made."""
    family, kind, protocol, _, place = address
    attempt = socket.socket(family, kind, protocol)
    try:
        attempt.setblocking(False)
        attempt.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if hasattr(socket, "TCP_USER_TIMEOUT"):  # Linux has it.
            attempt.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _LOST_MS)
        if (status := attempt.connect_ex(place)) not in (0, errno.EINPROGRESS):
            raise OSError(status, os.strerror(status))
    except OSError:
        attempt.close()
        raise
    return attempt


def main() -> int:
    """Exit code 0 where ssh has the connection."""
    host, port = sys.argv[1:]
    try:
        with connected(host, port) as connection, socket.socket(fileno=sys.stdout.fileno()) as ssh:
            socket.send_fds(ssh, [b"\0"], [connection.fileno()])
    except OSError as error:
        sys.stderr.write(f"ssh: connect to host {host} port {port}: {error.strerror or error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
