"""The life of a service process: settings in, bus open, serve, and a word on why it ended.

    python -m aos_registry SETTINGS.json

A service ends with its parent, on SIGTERM, or with a fault. SIGTERM cancels `serve`, which cleans up in
`finally`. A fault goes to the log on stderr and, for aos-up, to `<run_dir>/faults/<service>.json`. On a full
disk neither may have space: the exit status tells that, too.
"""

import asyncio
import gc
import logging
import os
import signal
import sys
import traceback
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any, Generic, NoReturn, TypeVar

import msgspec

from aos_protocol.codec import UNREADABLE
from aos_protocol.errors import AosError, DeployError, StorageError
from aos_protocol.keys import Keys
from aos_protocol.messages import Fault
from aos_protocol.spelling import error_text
from aos_runtime.bus.bus import Access, Bus
from aos_runtime.bus.config import LEASE_S
from aos_runtime.clock import Clock, SystemClock
from aos_runtime.code_places import place_of
from aos_runtime.older_python import BaseExceptionGroup
from aos_runtime.processes.ending import end
from aos_runtime.processes.parent import die_with_parent
from aos_runtime.processes.settings import ServiceSettings, fault_path

STORAGE_STATUS = os.EX_IOERR
"""The exit status of a service that could not write or read its files."""

S = TypeVar("S", bound=ServiceSettings)

_log = logging.getLogger("aos.service")


class Service(Generic[S]):
    """The surroundings that `serve` works with. `keys` are those of the robot; `bus` closes after `serve`
    has ended."""

    def __init__(self, settings: S, bus: Bus, clock: Clock) -> None:
        self.settings = settings
        self.bus = bus
        self.clock = clock
        self.keys = Keys(settings.robot)

    async def ready(self) -> None:
        """Declares the service present: call it once everything it answers is declared.

        DeployError AOS803 if one of the same name already is.
        """
        key = self.keys.live(self.settings.service)
        async with self.bus.presence(key) as present:
            if present.has_items:
                message = f"{self.settings.service} of the robot {self.settings.robot} is on this bus already"
                hint = "Stop the other one, or give this one another robot name or endpoint"
                raise DeployError(message, code="AOS803", hint=hint)
        await self.bus.announce(key)
        gc.freeze()  # What is there now stays; looking through it again and again takes milliseconds.
        _log.info("ready")


def run_service(
    settings_type: type[S],
    serve: Callable[[Service[S]], Awaitable[None]],
    *,
    lease_s: float = LEASE_S,
    settings: S | None = None,
    leave: Callable[[int], NoReturn] = end,
) -> NoReturn:
    """The whole of a service's `__main__`: runs `serve` until it returns, fails or is told to stop.

    The settings are given, or stand in the file that the command line names. `leave` ends the process.
    """

    async def run(settings: S) -> None:
        await serve_on_bus(settings, serve, lease_s=lease_s)

    run_process(settings_type, run, settings, leave=leave)


async def serve_on_bus(
    settings: S, serve: Callable[[Service[S]], Awaitable[None]], *, lease_s: float = LEASE_S
) -> None:
    """Opens the bus of the settings, and runs `serve` until it returns, fails or is cancelled."""
    clock = SystemClock()
    bus = await Bus.open(
        settings.endpoint,
        sender=settings.service,
        connect_timeout_s=settings.router_s,
        clock=clock,
        lease_s=lease_s,
        credential=settings.credential,
        access=Access(settings.robot, settings.party),
    )
    async with bus:
        await serve(Service(settings, bus, clock))


def run_process(
    settings_type: type[S],
    run: Callable[[S], Coroutine[Any, Any, None]],
    settings: S | None = None,
    *,
    leave: Callable[[int], NoReturn] = end,
) -> NoReturn:
    """Runs a process as `run_service` does, where it opens its own connection to the bus."""
    die_with_parent()
    settings = settings or _read_settings(settings_type)
    logging.basicConfig(
        level=os.environ.get("AOS_LOG", "INFO").upper(),
        format=f"%(asctime)s %(levelname)-7s {settings.service}: %(message)s",
        stream=sys.stderr,
    )
    try:
        asyncio.run(_until_told_to_stop(run(settings)))
    except AosError as error:
        _log.error("%s", error)
        _leave_fault(settings, Fault(error.code, error.message, error.hint, error.diagnostics))
        status = STORAGE_STATUS if isinstance(error, StorageError) else 1
    except Exception as error:
        _log.exception("ended by a defect")
        text = f"ended by a defect: {error_text(error)}"
        place = place_of(traceback.extract_tb(error.__traceback__))
        hint = f"It was raised in {place}; the log has all of it"
        _leave_fault(settings, Fault("AOS606", text, hint))
        status = 1
    else:
        status = 0
    logging.shutdown()
    leave(status)


async def _until_told_to_stop(work: Coroutine[Any, Any, None]) -> None:
    """Runs `work`; SIGTERM and SIGINT cancel it, which counts as a good end. Groups of one are unwrapped."""
    task = asyncio.ensure_future(work)
    is_stopping = False

    def stop() -> None:
        nonlocal is_stopping
        is_stopping = True
        task.cancel()

    loop = asyncio.get_running_loop()
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, stop)
    try:
        await task
    except asyncio.CancelledError:
        if not is_stopping:
            raise
    except BaseExceptionGroup as group:
        raise root_cause(group) from group


def root_cause(error: BaseException) -> BaseException:
    """The first AosError inside nested task groups, else the first exception; any other error itself."""
    if not isinstance(error, BaseExceptionGroup):
        return error
    causes = [root_cause(inner) for inner in error.exceptions]
    return next((cause for cause in causes if isinstance(cause, AosError)), causes[0])


def _read_settings(settings_type: type[S]) -> S:
    if len(sys.argv) != 2:
        sys.exit(f"usage: python -m {settings_type.__module__.split('.')[0]} SETTINGS.json")
    path = Path(sys.argv[1])
    try:
        return msgspec.json.decode(path.read_bytes(), type=settings_type)
    except (OSError, *UNREADABLE) as error:
        sys.exit(f"{path}: {error}")


def _leave_fault(settings: ServiceSettings, fault: Fault) -> None:
    path = fault_path(settings.run_dir, settings.service)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(msgspec.json.encode(fault))
    except OSError as error:
        _log.error("cannot write %s: %s", path, error)
