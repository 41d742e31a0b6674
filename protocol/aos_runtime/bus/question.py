"""One question on the bus: its receipt, its reply, and the replies that come when nobody waits any more.

Each question to a key of a client is answered by a task of its own.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Generic, TypeVar

import zenoh
from zenoh.handlers import Callback

from aos_protocol.codec import decode, decode_fault, encode, encode_fault
from aos_protocol.errors import AosError, BusError, LateAnswerError, LostAnswerError, NobodyAnswersError
from aos_protocol.messages import Message
from aos_protocol.spelling import error_text
from aos_runtime.background import Background
from aos_runtime.clock import Clock

R = TypeVar("R", bound=Message)

RECEIPT = b"taken"
"""The attachment of a question that asks for a receipt, and of the receipt: a first, empty reply. Somebody
who knows neither asks without, and answers without."""

_ZENOH_TIMEOUT = b"Timeout"
"""Zenoh's own error reply, the only one that is not an envelope."""

_MAX_STRAYS = 10
STRAYS_S = 60.0
"""A question hears of late replies this long after its deadline, where somebody wants to know."""


class Question(Generic[R]):
    """The replies to a question on `key`, from Zenoh's threads to the loop that asks.

    `settled` is done once a reply is there, or None once there will be none. `on_stray` is told of replies
    that come later, a few of them.
    """

    def __init__(
        self, key: str, reply: type[R], timeout_s: float, on_stray: Callable[[str, R | AosError], None] | None
    ) -> None:
        self._key = key
        self._reply = reply
        self._timeout_s = timeout_s
        self._on_stray = on_stray
        self._strays = 0
        self._is_taken = False
        self._loop = asyncio.get_running_loop()
        self.settled: asyncio.Future[tuple[bool, bytes] | None] = self._loop.create_future()

    @property
    def replies(self) -> Callback[zenoh.Reply]:
        """The callback for the query."""
        end = partial(self._loop.call_soon_threadsafe, self._settle, None)
        return Callback(self._on_reply, end, indirect=False)

    def answer(self) -> R:
        """The reply, or no reply in time where waiting was given up; errors as in `Bus.ask`."""
        result = (False, _ZENOH_TIMEOUT) if self.settled.cancelled() else self.settled.result()
        if result is None and self._is_taken:
            hint = "See the logs of the services for what ended"
            raise LostAnswerError(f"who took the question on {self._key} ended before the answer", hint=hint)
        return self._read(result)

    def _on_reply(self, received: zenoh.Reply) -> None:
        if received.ok is not None and received.ok.attachment is not None:
            self._loop.call_soon_threadsafe(self._take)
            return
        if received.ok is not None:
            result = (True, received.ok.payload.to_bytes())
        else:
            result = (False, received.err.payload.to_bytes() if received.err else b"")
        self._loop.call_soon_threadsafe(self._settle, result)

    def _take(self) -> None:
        self._is_taken = True

    def _settle(self, result: tuple[bool, bytes] | None) -> None:
        if not self.settled.done():
            self.settled.set_result(result)
        elif self._on_stray is not None and result is not None and self._strays < _MAX_STRAYS:
            self._strays += 1
            if result[1] != _ZENOH_TIMEOUT:
                self._on_stray("late" if self.settled.cancelled() else "repeated", self._stray(result))

    def _stray(self, result: tuple[bool, bytes]) -> R | AosError:
        try:
            return self._read(result)
        except AosError as error:
            return error

    def _read(self, result: tuple[bool, bytes] | None) -> R:
        if result is None:
            hint = "Is the service that should answer running?"
            raise NobodyAnswersError(f"nobody answers {self._key}", hint=hint)
        is_answer, payload = result
        if not is_answer and payload == _ZENOH_TIMEOUT:
            raise LateAnswerError(f"no answer on {self._key} within {self._timeout_s:g} s")
        try:
            if is_answer:
                return decode(payload, self._reply)
            fault = decode_fault(payload)
        except BusError as error:
            text = f"the answer on {self._key}: {error.message}"
            raise BusError(text, code=error.code, hint=error.hint) from error
        raise fault


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
