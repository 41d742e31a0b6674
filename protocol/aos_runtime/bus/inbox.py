"""The way of messages from Zenoh's threads to the event loop: some at a time, so that a flood of them leaves
time for everything else."""

from __future__ import annotations

import asyncio
import threading
from collections import deque
from collections.abc import Callable

_TURN = 20
"""So many messages are taken before the loop looks after the rest."""


class Inbox:
    """Runs what is put into it on the loop, in this order."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._waiting: deque[Callable[[], None]] = deque()
        self._lock = threading.Lock()
        self._is_awake = False

    def put(self, take: Callable[[], None]) -> None:
        """Takes a call from any thread."""
        with self._lock:
            self._waiting.append(take)
            if self._is_awake:
                return
            self._is_awake = True
        self._loop.call_soon_threadsafe(self._take_some)

    def _take_some(self) -> None:
        for _ in range(_TURN):
            with self._lock:
                if not self._waiting:
                    self._is_awake = False
                    return
                take = self._waiting.popleft()
            take()
        self._loop.call_soon(self._take_some)
