"""The configuration of every Zenoh session of AOS: the only file that names Zenoh's options.

One router, all others its clients: no scouting, no gossip, no listening anywhere but where the deploy file
says. Zenoh itself refuses options it does not know.
"""

from __future__ import annotations

import asyncio
import json
import re
from pathlib import Path
from typing import Any

import zenoh

from aos_protocol.errors import BusError
from aos_runtime.bus.credentials import Credential

LEASE_S = 2.0
"""A process that is silent for this long is taken for gone. One that ends is noticed at once."""

ADAPTER_LEASE_S = 0.8
"""The same for an adapter, whose skills are to be unavailable within a second. Losing one for a moment costs
less than losing a service: its call is unknown, and the mission goes on."""

_RETRY = {"period_init_ms": 50, "period_max_ms": 400, "period_increase_factor": 2}
"""The waits of a client that seeks a router that has gone."""

_ENDPOINT = re.compile(r"(tcp|udp|tls|quic|ws|unixsock-stream)/\S+")

_COMMON: dict[str, Any] = {
    # Without the delay a router waits half a second at start for peers that scouting would find.
    "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": False}},
    "adminspace": {"enabled": False},
}


def client_config(
    endpoint: str, *, credential: Credential | None = None, lease_s: float = LEASE_S, stamps: bool = False
) -> zenoh.Config:
    """A client of the router at `endpoint`, such as `tcp/127.0.0.1:7447`. Opening it tries once.

    A router that knows its clients wants a `credential`. It takes the client for gone when it is silent for
    `lease_s`. Publishers that keep a history for late comers need `stamps`, a time on all that is sent.
    """
    connect = {"endpoints": [_checked(endpoint)], "timeout_ms": 0, "retry": _RETRY}
    options = {"mode": "client", "connect": connect, "timestamping": {"enabled": stamps}}
    auth = None if credential is None else {"user": credential.user, "password": credential.password}
    return _config(options, lease_s, auth)


async def opened_session(
    config: zenoh.Config, timeout_s: float, retry_s: float, fault: BusError
) -> zenoh.Session:
    """A session that waits for its router to come up; raises the fault if it does not in time."""
    loop = asyncio.get_running_loop()
    deadline_s = loop.time() + timeout_s
    while True:
        try:
            return await asyncio.to_thread(zenoh.open, config)
        except zenoh.ZError as error:
            if loop.time() >= deadline_s:
                raise fault from error
            await asyncio.sleep(retry_s)


def router_config(
    endpoint: str, *, access: dict[str, Any] | None = None, dictionary: Path | None = None
) -> zenoh.Config:
    """The router, listening at `endpoint` and nowhere else.

    With a `dictionary` of names and passwords nobody else gets in, and they may do what `access` says.
    Without one it carries everything for everybody, as the routers of other systems do.
    """
    options: dict[str, Any] = {"mode": "router", "listen": {"endpoints": [_checked(endpoint)]}}
    if access is not None:
        options["access_control"] = access
    return _config(options, auth=None if dictionary is None else {"dictionary_file": str(dictionary)})


def _config(
    options: dict[str, Any], lease_s: float = LEASE_S, auth: dict[str, str] | None = None
) -> zenoh.Config:
    transport: dict[str, Any] = {
        "link": {"tx": {"lease": int(lease_s * 1000)}},
        # Shared memory would leave files behind when a process is killed.
        "shared_memory": {"enabled": False},
    }
    if auth is not None:
        transport["auth"] = {"usrpwd": auth}
    return zenoh.Config.from_json5(json.dumps(_COMMON | {"transport": transport} | options))


def _checked(endpoint: str) -> str:
    if not _ENDPOINT.fullmatch(endpoint):
        raise BusError(
            f"{endpoint!r} is not a bus endpoint", code="AOS605", hint="Write it as tcp/127.0.0.1:7447"
        )
    return endpoint
