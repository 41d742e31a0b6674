"""A run that a signal ends: in order by the first, at once by any further one."""

from __future__ import annotations

import asyncio
import signal
from typing import Protocol

__all__ = ["Stoppable", "run_until_interrupted"]

_STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class _End(Protocol):
    @property
    def exit_code(self) -> int: ...


class Stoppable(Protocol):
    """A run that lasts until it ends or is cancelled, and that can be ended at once."""

    async def run(self) -> _End: ...

    def kill(self) -> None: ...


async def run_until_interrupted(mission: Stoppable) -> int:
    """The exit code. The first signal stops everything in order, any further one at once.

    A signal after the end changes nothing: the process ignores it from then on.
    """
    loop = asyncio.get_running_loop()
    work = loop.create_task(mission.run())
    has_interrupted = False

    def interrupt() -> None:
        nonlocal has_interrupted
        if has_interrupted:
            mission.kill()
        else:
            has_interrupted = True
            work.cancel()

    for number in _STOPPING:
        loop.add_signal_handler(number, interrupt)
    try:
        return (await work).exit_code
    finally:
        for number in _STOPPING:
            loop.remove_signal_handler(number)
            signal.signal(number, signal.SIG_IGN)
