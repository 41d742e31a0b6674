"""The bus router as a process: `python -m aos_runtime.router SETTINGS.json`.

The settings are those of every service; `endpoint` is where it listens.
"""

from __future__ import annotations

import asyncio
import logging

import zenoh

from aos_protocol.errors import BusError
from aos_runtime.bus_config import router_config
from aos_runtime.lifecycle import ServiceSettings, run_process

__all__ = ["route"]

_log = logging.getLogger("aos.router")


async def route(settings: ServiceSettings) -> None:
    """Routes until cancelled. BusError AOS605 if the endpoint cannot be listened on."""
    try:
        session = zenoh.open(router_config(settings.endpoint))
    except zenoh.ZError as error:
        raise BusError(
            f"the router cannot listen at {settings.endpoint}: {error}",
            code="AOS605",
            hint="Another program listens there? Give another endpoint, or port 0 for any free one",
        ) from error
    _log.info("listening at %s", settings.endpoint)
    try:
        await asyncio.get_running_loop().create_future()
    finally:
        session.close()


if __name__ == "__main__":
    run_process(ServiceSettings, route)
