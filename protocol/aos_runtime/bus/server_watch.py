"""A watch on whether somebody serves a key, while a question on it is open."""

from __future__ import annotations

import asyncio
from typing import Any

import zenoh
from zenoh.handlers import Callback


class ServerWatch:
    """Knows when all who serve the key have left it, as far as the router tells. Make it after the question.

    The router ends the questions of a link that breaks, and forwards for a moment longer to it: nobody tells
    of a question that comes in between. Who serves the key afterwards knows nothing of that question.

    While a watch is open, Zenoh answers further questions on its key from what the router last told of it:
    a server that came this moment may be passed over. So a watch ends when the servers have left.
    """

    def __init__(self, session: zenoh.Session, key: str) -> None:
        loop = asyncio.get_running_loop()
        self.has_left: asyncio.Future[None] = loop.create_future()
        self.hears_of_leaving = False
        """True once Zenoh has told of a server: only then does it tell that there is none any more."""

        def on_change(status: Any) -> None:  # Zenoh's stub names no type.
            loop.call_soon_threadsafe(self._hear if status.matching else self._leave)

        self._is_ended = False
        self._querier = session.declare_querier(key)
        self._listener = self._querier.declare_matching_listener(Callback(on_change, indirect=False))

    @property
    def is_served(self) -> bool:
        """False once the watch has ended.

        Means nothing before the router has answered: a round trip on the session comes back after that.
        """
        if self._is_ended:
            return False
        status: Any = self._querier.matching_status  # Zenoh's stub says bool.
        return bool(status.matching)

    def end(self) -> None:
        """Ends the watch; it must not be called after the session has ended, and ending twice does
        nothing."""
        if not self._is_ended:
            self._is_ended = True
            self._listener.undeclare()
            self._querier.undeclare()

    def _hear(self) -> None:
        self.hears_of_leaving = True

    def _leave(self) -> None:
        if not self._is_ended:
            self.has_left.set_result(None)
            self.end()
