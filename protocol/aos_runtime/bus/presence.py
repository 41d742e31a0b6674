"""Presence: the keys that are there on the bus, and who serves them, as one session hears it."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import Any

import zenoh
from zenoh.handlers import Callback

from aos_runtime.bus.subscription import Inbox, Subscription

Changes = Subscription[tuple[str, bool]]


class Presence:
    """The keys that match an expression and are present, for as long as the session lasts.

    Zenoh tells a second watch of a session what the session has heard, beside the order in which it hears: a
    key that goes in that moment, or that went when a watch ended, stays present for the second one. So a
    session watches once, never ends it, and tells all who ask out of what it has heard.
    """

    def __init__(self, session: zenoh.Session, inbox: Inbox, key_expression: str) -> None:
        self._expression = zenoh.KeyExpr(key_expression)
        self._present: dict[str, None] = {}
        self._followers: dict[Changes, zenoh.KeyExpr] = {}

        def on_sample(sample: zenoh.Sample) -> None:
            is_alive = sample.kind == zenoh.SampleKind.PUT
            inbox.put(partial(self._take, str(sample.key_expr), is_alive))

        # A round trip on the session comes back after the keys that are present now.
        self._subscriber = session.liveliness().declare_subscriber(
            key_expression, Callback(on_sample, indirect=False), history=True
        )

    def includes(self, key_expression: str) -> bool:
        """Says whether all that match `key_expression` are heard of here."""
        return self._expression.includes(zenoh.KeyExpr(key_expression))

    def follow(self, key_expression: str, changes: Changes) -> None:
        """Pushes the keys of `key_expression` that are present, and then each change, until `leave`."""
        expression = zenoh.KeyExpr(key_expression)
        for key in self._present:
            if expression.intersects(zenoh.KeyExpr(key)):
                changes.push((key, True))
        self._followers[changes] = expression

    def leave(self, changes: Changes) -> None:
        """Pushes nothing more; leaving twice does nothing."""
        self._followers.pop(changes, None)

    def _take(self, key: str, is_alive: bool) -> None:
        if is_alive is (key in self._present):  # Zenoh may repeat what it said.
            return
        if is_alive:
            self._present[key] = None
        else:
            del self._present[key]
        for changes, expression in tuple(self._followers.items()):
            if expression.intersects(zenoh.KeyExpr(key)):
                changes.push((key, is_alive))


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
