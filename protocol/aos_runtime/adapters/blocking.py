"""Adapters that hold up their event loop: such a call cannot be cancelled, and nothing else can be called."""

import asyncio
import faulthandler
import logging
import os
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from aos_runtime.code_places import place_of

_ANSWER_S = 5.0
"""The time that the loop may take to answer: after a pause of the whole process it has to catch up first."""

_LONGEST_S = 1e9
_STDERR = 2
"""The log, also where `sys.stderr` has been replaced."""

_log = logging.getLogger("aos.adapter")


@contextmanager
def ends_if_blocked(what: str, after_s: float) -> Iterator[None]:
    """Ends the process if the event loop stands still when the block has lasted for so many seconds.

    Whoever started it can then start it again. The log says where the loop stood.
    """
    loop, thread = asyncio.get_running_loop(), threading.get_ident()

    def end() -> None:
        turns = threading.Event()
        loop.call_soon_threadsafe(turns.set)
        if turns.wait(_ANSWER_S):
            return
        place = place_of(traceback.extract_stack(sys._current_frames().get(thread)))
        _log.critical(
            "%s holds up everything at %s, and cannot be stopped: the process ends. "
            "In an `async def`, await what takes time, or hand it to asyncio.to_thread",
            what,
            place,
        )
        logging.shutdown()
        os._exit(1)

    timer = threading.Timer(after_s, end)
    timer.daemon = True
    timer.start()
    # C code that keeps Python's lock lets no thread of Python run: this one is of C, and needs no lock.
    at_last_s = min(after_s + _ANSWER_S + 1.0, _LONGEST_S)
    faulthandler.dump_traceback_later(at_last_s, exit=True, file=_STDERR)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
        timer.cancel()
