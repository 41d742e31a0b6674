"""A run that a signal ends: in order by the first, at once by any further one.

It also ends in order where nobody reads any more what it tells, as in `aos-up | head` and in a terminal that
was closed.
"""

import asyncio
import errno
import os
import signal
import sys
from contextlib import suppress
from typing import Protocol

from aos_deploy.events import Event, Report

ECHO_S = 0.3
_LOOK_S = 0.5
"""A terminal is looked at this often: a skill may take long, and nothing is told meanwhile."""
_STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class _End(Protocol):
    @property
    def exit_code(self) -> int: ...


class Stoppable(Protocol):
    """A run that lasts until it ends or is cancelled, and that can be ended at once."""

    async def run(self) -> _End: ...

    def kill(self) -> None: ...


def told_while_read(report: Report, is_unread: asyncio.Event) -> Report:
    """The report. It sets `is_unread` once its pipe or terminal is gone, and is mute from then on."""

    def tell(event: Event) -> None:
        try:
            report(event)
        except OSError as error:
            if error.errno not in (errno.EPIPE, errno.EIO):
                raise
            is_unread.set()
            _mute()

    return tell


def _mute() -> None:
    """Lets whatever is printed from now on go nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def _is_terminal() -> bool:
    return sys.stdout is not None and sys.stdout.isatty()  # None where it was closed before.


async def run_until_interrupted(mission: Stoppable, is_unread: asyncio.Event) -> int:
    """The exit code. The first signal stops everything in order, any further one at once. Everything stops in
    order also where nobody reads any more.

    A signal that comes within ECHO_S of the first is the same one: `timeout` and terminals send it to a
    process and to its group. That of a terminal which was closed may come after that was noticed. A signal
    after the end changes nothing: the process ignores it from then on.
    """
    loop = asyncio.get_running_loop()
    is_terminal = _is_terminal()
    work = loop.create_task(mission.run())
    interrupted_s: float | None = None

    def stop() -> None:
        if not work.cancelling():  # Ctrl-C ends the reader as well.
            work.cancel()

    def interrupt() -> None:
        nonlocal interrupted_s
        if interrupted_s is None:
            interrupted_s = loop.time()
            stop()
        elif loop.time() - interrupted_s > ECHO_S:
            mission.kill()

    async def stop_unread() -> None:
        while not is_unread.is_set() and is_terminal == _is_terminal():
            with suppress(TimeoutError):
                await asyncio.wait_for(is_unread.wait(), _LOOK_S)
        stop()

    for number in _STOPPING:
        loop.add_signal_handler(number, interrupt)
    reader = loop.create_task(stop_unread())
    try:
        return (await work).exit_code
    finally:
        reader.cancel()
        if is_terminal and not _is_terminal():
            _mute()  # It was closed, and a view still has to end.
        for number in _STOPPING:
            loop.remove_signal_handler(number)
            signal.signal(number, signal.SIG_IGN)
