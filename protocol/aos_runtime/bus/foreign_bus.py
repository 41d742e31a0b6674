"""Other people's protocols on Zenoh: bytes with attachments, where `bus` has typed messages with envelopes.

The second door to zenoh. The rules of `bus` hold here, too: callbacks run on Zenoh's threads and only hand
over to the event loop; a query is dropped as soon as it is answered; an empty answer, a late one and a
refusal are different errors.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable
from functools import partial
from typing import NamedTuple, Self

import zenoh
import zenoh.ext
from zenoh.handlers import Callback

from aos_protocol.errors import BusError, LateAnswerError, NobodyAnswersError
from aos_runtime.background import Background, Closing
from aos_runtime.bus.config import client_config, opened_session

_RETRY_S = 0.05
_LATE_S = 0.5

_log = logging.getLogger("aos.foreign_bus")

Undo = Callable[[], None]


class Packet(NamedTuple):
    """A sent message: a payload, and the attachment beside it."""

    payload: bytes
    attachment: bytes = b""


class ForeignBus(Closing):
    """A client's session on a router that may be of others. Belongs to the event loop that opened it."""

    def __init__(self, session: zenoh.Session) -> None:
        self.id = str(session.info.zid())
        self._session = session
        self._loop = asyncio.get_running_loop()
        self._answering = Background()
        self._declared: dict[int, Undo] = {}
        self._numbers = 0
        self._is_closed = False

    @classmethod
    async def open(cls, endpoint: str, *, connect_timeout_s: float) -> Self:
        """Connects, waiting for the router to come up; BusError AOS605 if it does not in time."""
        fault = BusError(
            f"no Zenoh router answers at {endpoint}",
            code="AOS605",
            hint="With rmw_zenoh, start it with: ros2 run rmw_zenoh_cpp rmw_zenohd",
        )
        config = client_config(endpoint, stamps=True)
        return cls(await opened_session(config, connect_timeout_s, _RETRY_S, fault))

    async def close(self) -> None:
        """Ends all that was declared here and running handlers. Closing twice does nothing."""
        if self._is_closed:
            return
        self._is_closed = True
        # A session with a subscriber that keeps history does not close before that is undeclared.
        for undo in list(self._declared.values()):
            undo()
        await self._answering.cancel()
        await asyncio.to_thread(self._session.close)

    async def ask(self, key: str, packet: Packet, *, timeout_s: float) -> Packet:
        """The first answer of those who answer `key` completely.

        NobodyAnswersError if nobody does, LateAnswerError if none comes in time, AOS606 if it is refused.
        """
        answer: asyncio.Future[tuple[bool, Packet] | None] = self._loop.create_future()

        def settle(result: tuple[bool, Packet] | None) -> None:
            if not answer.done():
                answer.set_result(result)

        def on_reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                result = (True, _packet(reply.ok.payload, reply.ok.attachment))
            else:
                result = (False, Packet(reply.err.payload.to_bytes() if reply.err else b""))
            self._loop.call_soon_threadsafe(settle, result)

        self._session.get(
            key,
            Callback(on_reply, partial(self._loop.call_soon_threadsafe, settle, None), indirect=False),
            payload=packet.payload,
            attachment=packet.attachment,
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=timeout_s,
        )
        try:
            async with asyncio.timeout(timeout_s + _LATE_S):
                result = await answer
        except TimeoutError:
            result = (False, Packet(b"Timeout"))
        if result is None:
            raise NobodyAnswersError(f"nobody answers {key}")
        is_answer, received = result
        if is_answer:
            return received
        if received.payload == b"Timeout":
            raise LateAnswerError(f"no answer on {key} within {timeout_s:g} s")
        raise BusError(f"{key} refused: {received.payload.decode(errors='replace')}", code="AOS606")

    def answer(self, key: str, handler: Callable[[Packet], Awaitable[Packet]]) -> Undo:
        """Answers `key` until undone: each question runs the handler as a task; what it raises is refused."""

        def on_query(query: zenoh.Query) -> None:
            self._loop.call_soon_threadsafe(self._start_answering, query, handler)

        queryable = self._session.declare_queryable(key, Callback(on_query, indirect=False), complete=True)
        return self._undo(queryable.undeclare)

    def publisher(self, key: str, *, cached: int = 0) -> Callable[[Packet], None]:
        """Sends on `key`; who comes late is given the last `cached` packets."""
        if not cached:
            return lambda packet: self._session.put(
                key,
                packet.payload,
                attachment=packet.attachment,
                congestion_control=zenoh.CongestionControl.BLOCK,
            )
        publisher = zenoh.ext.declare_advanced_publisher(
            self._session, key, cache=zenoh.ext.CacheConfig(max_samples=cached), publisher_detection=True
        )
        self._undo(publisher.undeclare)
        return lambda packet: publisher.put(packet.payload, attachment=packet.attachment)

    def listen(self, key: str, take: Callable[[Packet], None], *, with_history: bool = False) -> Undo:
        """Has packets on `key` taken on the event loop; with history, also those that publishers cached."""

        def on_sample(sample: zenoh.Sample) -> None:
            packet = _packet(sample.payload, sample.attachment)
            self._loop.call_soon_threadsafe(self._take, take, packet)

        callback = Callback(on_sample, indirect=False)
        if not with_history:
            return self._undo(self._session.declare_subscriber(key, callback).undeclare)
        history = zenoh.ext.HistoryConfig(detect_late_publishers=True)
        advanced = zenoh.ext.declare_advanced_subscriber(self._session, key, callback, history=history)
        return self._undo(advanced.undeclare)

    def announce(self, key: str) -> Undo:
        """Makes `key` present until undone, or until this process ends, however it ends."""
        return self._undo(self._session.liveliness().declare_token(key).undeclare)

    def watch(self, key_expression: str, on_change: Callable[[str, bool], None]) -> Undo:
        """Says on the event loop which keys are present, and later which come and go; may repeat itself."""

        def on_sample(sample: zenoh.Sample) -> None:
            is_present = sample.kind == zenoh.SampleKind.PUT
            self._loop.call_soon_threadsafe(on_change, str(sample.key_expr), is_present)

        subscriber = self._session.liveliness().declare_subscriber(
            key_expression, Callback(on_sample, indirect=False), history=True
        )
        return self._undo(subscriber.undeclare)

    def _undo(self, undeclare: Undo) -> Undo:
        self._numbers += 1
        number = self._numbers

        def undo() -> None:
            if self._declared.pop(number, None) is not None:
                undeclare()

        self._declared[number] = undo
        return undo

    def _take(self, take: Callable[[Packet], None], packet: Packet) -> None:
        if not self._is_closed:
            take(packet)

    def _start_answering(self, query: zenoh.Query, handler: Callable[[Packet], Awaitable[Packet]]) -> None:
        if self._is_closed:
            query.drop()
            return
        self._answering.begin(self._answer_one(query, handler))

    async def _answer_one(self, query: zenoh.Query, handler: Callable[[Packet], Awaitable[Packet]]) -> None:
        with query:
            try:
                answer = await handler(_packet(query.payload, query.attachment))
            except asyncio.CancelledError:
                raise
            except Exception as error:
                _log.warning("%s is refused: %s", query.key_expr, error)
                _reply(query, None, str(error))
            else:
                _reply(query, answer, "")


def _reply(query: zenoh.Query, answer: Packet | None, refusal: str) -> None:
    try:
        if answer is None:
            query.reply_err(refusal.encode())
        else:
            query.reply(query.key_expr, answer.payload, attachment=answer.attachment)
    except zenoh.ZError as error:
        _log.warning("the answer on %s was not delivered: %s", query.key_expr, error)


def _packet(payload: zenoh.ZBytes | None, attachment: zenoh.ZBytes | None) -> Packet:
    return Packet(
        payload.to_bytes() if payload is not None else b"",
        attachment.to_bytes() if attachment is not None else b"",
    )
