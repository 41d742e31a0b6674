"""The bus router as a service.

The settings are those of every service; `endpoint` is where it listens.
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import ExitStack
from pathlib import Path

import zenoh

from aos_protocol.access import Party
from aos_protocol.errors import BusError
from aos_runtime.bus.config import router_config
from aos_runtime.processes.settings import ServiceSettings
from aos_runtime.router.access import access_control
from aos_runtime.router.log import refusals_logged

_log = logging.getLogger("aos.router")


class RouterSettings(ServiceSettings, frozen=True, kw_only=True):
    """`dictionary` has the names and passwords of the `parties`, a line for each.

    It is removed once it is read. Without one, everybody may do everything. At `ros2` nodes of ROS 2 meet: a
    router for them alone, which shares nothing with the bus.
    """

    dictionary: str = ""
    parties: tuple[Party, ...] = ()
    ros2: str = ""


async def route(settings: RouterSettings) -> None:
    """Routes until cancelled. BusError AOS605 if an endpoint cannot be listened on, or passwords are
    missing."""
    dictionary = Path(settings.dictionary) if settings.dictionary else None
    with ExitStack() as stack:
        access = None
        if dictionary is not None:
            access = access_control(settings.robot, settings.parties)
            stack.enter_context(refusals_logged(zenoh.init_log_from_env_or))
        try:
            config = router_config(settings.endpoint, access=access, dictionary=dictionary)
            stack.enter_context(_listening(config, settings.endpoint))
        finally:
            if dictionary is not None:
                dictionary.unlink(missing_ok=True)
        if settings.ros2:
            stack.enter_context(_listening(router_config(settings.ros2), settings.ros2))
        await asyncio.get_running_loop().create_future()


def _listening(config: zenoh.Config, endpoint: str) -> zenoh.Session:
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        message = f"the router cannot listen at {endpoint}: {error}"
        hint = "Another program listens there? Give another endpoint, or port 0 for any free one"
        raise BusError(message, code="AOS605", hint=hint) from error
    _log.info("listening at %s", endpoint)
    return session
