"""The pauses of a process: times when its event loop stood still, and what came meanwhile may be outdated."""

from __future__ import annotations

import asyncio

from aos_runtime.bus.config import ADAPTER_LEASE_S

_TURN_S = 0.1
_PAUSE_S = ADAPTER_LEASE_S / 2
"""A loop that stands still for longer may have left the bus without knowing it."""
_CATCHES_UP_S = 2.0
"""Messages that have waited for the process come for this long after its pause, at most."""


class Pauses:
    """Watches the event loop while the block runs."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._turned_s = self._loop.time()
        self._paused_until_s = float("-inf")
        self._timer: asyncio.TimerHandle | None = None

    def __enter__(self) -> Pauses:
        self._turned_s = self._loop.time()
        self._turn()
        return self

    def __exit__(self, *_: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    @property
    def was_there_one(self) -> bool:
        """Says whether what comes now may have waited while the loop stood still."""
        if self._timer is None:
            return False
        now_s = self._note()
        return now_s - self._paused_until_s < _CATCHES_UP_S

    def _turn(self) -> None:
        self._turned_s = self._note()
        self._timer = self._loop.call_later(_TURN_S, self._turn)

    def _note(self) -> float:
        """Returns the time, and keeps it where a pause ends."""
        now_s = self._loop.time()
        if now_s - self._turned_s > _PAUSE_S:
            self._paused_until_s = now_s
        return now_s
