"""The endpoint of a system: held by one start alone, before any of its processes runs."""

import random
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from aos_protocol.errors import BusError

_PORT_RANGE = Path("/proc/sys/net/ipv4/ip_local_port_range")
_LOWEST_PORT = 20_000
_ATTEMPTS = 100


@contextmanager
def hold_endpoint(endpoint: str) -> Iterator[str]:
    """Keeps an endpoint for this process until the block ends; gives it with a free port in place of port 0.

    An empty one stands for a socket in the run directory, which nobody else can take.

    Two starts that only look whether a port is free may both find it so, and then the services of one meet
    the router of the other. So a start first takes a name that the kernel gives to one process at a time, and
    takes back however that process ends. BusError AOS802 if another start has it, or any program listens.
    """
    if not endpoint:
        yield ""
        return
    address, _, port = endpoint.replace("tcp/localhost:", "tcp/127.0.0.1:").rpartition(":")
    with socket.socket(socket.AF_UNIX) as name:
        if port != "0":
            _take(name, address, int(port))
        else:
            port = str(_take_any(name, address))
        yield f"{address}:{port}"


def _take(name: socket.socket, address: str, port: int) -> None:
    if not _has_taken(name, address, port):
        raise _refusal(address, port, "another AOS runs there")
    try:
        _try_to_bind(address, port)
    except OSError as error:
        raise _refusal(address, port, error.strerror or str(error)) from error


def _take_any(name: socket.socket, address: str) -> int:
    """A port below those that the kernel gives to outgoing connections, which could take it meanwhile."""
    end = int(_PORT_RANGE.read_text().split()[0]) if _PORT_RANGE.exists() else 0
    candidates = range(_LOWEST_PORT, end) if end > _LOWEST_PORT else range(_LOWEST_PORT, 2**16)
    for port in random.SystemRandom().sample(candidates, _ATTEMPTS):
        try:
            _try_to_bind(address, port)
        except OSError:
            continue
        if _has_taken(name, address, port):
            return port
    raise _refusal(address, 0, "there is no free port")


def _has_taken(name: socket.socket, address: str, port: int) -> bool:
    """Binds the endpoint's name, an abstract socket of Linux; returns whether this start has it now."""
    try:
        name.bind(f"\0aos-{address}:{port}")
    except OSError:
        return False
    return True


def _try_to_bind(address: str, port: int) -> None:
    """Raises OSError if somebody listens there."""
    family = socket.AF_INET6 if "[" in address else socket.AF_INET
    with socket.socket(family) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind((address.partition("/")[2].strip("[]"), port))


def _refusal(address: str, port: int, reason: str) -> BusError:
    hint = "`aos runs` lists what runs; stop it, or use --listen tcp/127.0.0.1:0 for a free port"
    return BusError(f"cannot listen at {address}:{port}: {reason}", code="AOS802", hint=hint)
