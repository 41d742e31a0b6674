"""The answers of a client of the bus: each question to one of its keys is a task of its own."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from typing import TypeVar

import zenoh
from zenoh.handlers import Callback

from aos_protocol.codec import decode, encode, encode_fault
from aos_protocol.errors import AosError, BusError, LostAnswerError
from aos_protocol.messages import Message
from aos_protocol.spelling import error_text
from aos_runtime.background import Background
from aos_runtime.bus.question import RECEIPT
from aos_runtime.clock import Clock

M = TypeVar("M", bound=Message)

Handler = Callable[[M, str], Awaitable[Message]]
"""Returns the answer to a message that was asked on a key."""

_log = logging.getLogger("aos.bus")


class Answers:
    """Answers questions until it is closed. Belongs to the event loop that made it."""

    def __init__(self, session: zenoh.Session, sender: str, clock: Clock) -> None:
        self._session = session
        self._sender = sender
        self._clock = clock
        self._loop = asyncio.get_running_loop()
        self._queryables: list[zenoh.Queryable[None]] = []
        self._answering = Background()
        self._is_closed = False

    def begin(self, key: str, request: type[M], handler: Handler[M]) -> None:
        """Questions to `key` are answered from the time on at which the router knows of it."""

        def on_query(query: zenoh.Query) -> None:
            self._loop.call_soon_threadsafe(self._start, query, request, handler)

        self._queryables.append(self._session.declare_queryable(key, Callback(on_query, indirect=False)))

    async def close(self) -> None:
        """Takes no more questions, and cancels the handlers that run: their askers hear of it."""
        self._is_closed = True
        for queryable in self._queryables:
            queryable.undeclare()
        await self._answering.cancel()

    def _start(self, query: zenoh.Query, request: type[M], handler: Handler[M]) -> None:
        if self._is_closed:
            query.drop()
            return
        self._answering.begin(self._answer(query, request, handler))

    async def _answer(self, query: zenoh.Query, request: type[M], handler: Handler[M]) -> None:
        # The asker waits out its whole deadline while a query is referenced, replied or not.
        with query:
            key = str(query.key_expr)
            try:
                if query.attachment is not None:
                    query.reply(query.key_expr, b"", attachment=RECEIPT, express=True)
                if "*" in key:
                    raise BusError(f"a question to {key} has no one answer", code="AOS602")
                payload = query.payload.to_bytes() if query.payload is not None else b""
                result = await handler(decode(payload, request), key)
                answer = encode(result, sender=self._sender, stamp_ns=self._clock.now_ns())
            except AosError as error:
                self._refuse(query, error)
            except asyncio.CancelledError:
                self._refuse(query, LostAnswerError(f"{self._sender} stopped while it answered {key}"))
                raise
            except Exception as error:
                _log.exception("the handler of %s failed", key)
                text = f"{self._sender} failed on {key}: {error_text(error)}"
                self._refuse(query, BusError(text, code="AOS606", hint=f"See the log of {self._sender}"))
            else:
                try:
                    query.reply(query.key_expr, answer, express=True)
                except zenoh.ZError as error:
                    _log.warning("the answer on %s was not delivered: %s", key, error)

    def _refuse(self, query: zenoh.Query, error: AosError) -> None:
        try:
            query.reply_err(encode_fault(error, sender=self._sender, stamp_ns=self._clock.now_ns()))
        except (zenoh.ZError, BusError) as failure:
            _log.warning("the refusal on %s was not delivered: %s", query.key_expr, failure)
