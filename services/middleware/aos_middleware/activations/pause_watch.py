"""Notices that this process stood still, as one does that a signal has frozen."""

import asyncio
import logging

from aos_runtime.bus.config import LEASE_S
from aos_runtime.clock import Clock

_LOOK_S = 0.25
_PAUSE_S = 0.7 * LEASE_S - _LOOK_S
"""The router, which hears of this process each quarter of the lease, may take it for dead after this."""

_log = logging.getLogger("aos.middleware")


class PauseWatch:
    """Compares the time between two looks at the clock with what it should be."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._looked_at_s = clock.monotonic_s()
        self._has_paused = False

    async def follow(self) -> None:
        """Looks at the clock until it is cancelled."""
        while True:
            await asyncio.sleep(_LOOK_S)
            self._look()

    def stood_still(self) -> bool:
        """Returns whether there was a pause since the last call that the router may have noticed."""
        self._look()  # The caller may run before `follow`, which was to look earlier.
        told, self._has_paused = self._has_paused, False
        return told

    def _look(self) -> None:
        now_s = self._clock.monotonic_s()
        pause_s, self._looked_at_s = now_s - self._looked_at_s - _LOOK_S, now_s
        if pause_s >= _PAUSE_S:
            self._has_paused = True
            _log.warning("the middleware stood still for %.1f s, as if frozen by a signal", pause_s)
