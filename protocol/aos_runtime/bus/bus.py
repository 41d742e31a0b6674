"""The bus: typed questions, answers, streams and presence over Zenoh, for asyncio.

Zenoh calls back on its own network threads. A callback here does one thing, `call_soon_threadsafe`, and runs
on that thread itself (`indirect=False`): with a Python thread for each subscriber the interpreter cannot end
while one is open. Everything else happens on the event loop that opened the bus.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

import zenoh
from zenoh.handlers import Callback

from aos_protocol.access import ROUND_TRIP, Act
from aos_protocol.codec import decode, encode
from aos_protocol.errors import AosError, BusError
from aos_protocol.messages import Message
from aos_runtime.background import Closing
from aos_runtime.bus.access_check import Access
from aos_runtime.bus.config import LEASE_S, client_config, opened_session
from aos_runtime.bus.credentials import Credential
from aos_runtime.bus.presence import Presence, ServerWatch
from aos_runtime.bus.question import RECEIPT, STRAYS_S, Answers, Handler, Question
from aos_runtime.bus.recurring import Recurring
from aos_runtime.bus.subscription import Inbox, Subscription, Undeclare
from aos_runtime.clock import Clock, SystemClock
from aos_runtime.older_python import timeout

__all__ = ["Access", "Bus", "Subscription"]

M = TypeVar("M", bound=Message)
R = TypeVar("R", bound=Message)

_RETRY_S = 0.02
_ROUND_TRIP_S = 2.0
_ROUND_TRIPS = 5
"""The router is asked this many times: on a machine that stands still for a while a link is lost, and made
anew."""

_LATE_S = 0.5
"""A question ends this long after Zenoh's own deadline by ours, in case Zenoh says nothing."""

_LINK_S = 0.05
_UNANSWERED_S = 1.0
"""An open question asks this often whether its key is served still, and waits this long for an answer under
way whose giver has left."""

_UNHEARD_S = 0.002
"""It asks this often until it will hear that who serves its key leaves: another may serve the next moment."""

_log = logging.getLogger("aos.bus")


class Bus(Closing):
    """A client's session on the bus. Belongs to the event loop that opened it; close it before that ends."""

    def __init__(
        self, session: zenoh.Session, sender: str, clock: Clock, access: Access | None = None
    ) -> None:
        self.sender = sender
        self._access = access
        self._session = session
        self._clock = clock
        self._loop = asyncio.get_running_loop()
        self._inbox = Inbox(self._loop)
        self._unread = Recurring(_log.warning)
        self._answers = Answers(session, sender, clock)
        self._subscriptions: set[Subscription[Any]] = set()
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self._presences: list[Presence] = []
        # `session.is_closed()` takes a lock of Zenoh's without letting the interpreter go, while a callback
        # holds that lock and waits for the interpreter: asked on a busy session, it hangs both for ever.
        self._is_closed = False

    @classmethod
    async def open(
        cls,
        endpoint: str,
        *,
        sender: str,
        connect_timeout_s: float = 5.0,
        clock: Clock | None = None,
        lease_s: float = LEASE_S,
        credential: Credential | None = None,
        access: Access | None = None,
    ) -> Bus:
        """Connects to the router, waiting for it to come up; BusError AOS605 if it does not in time.

        A process that freezes has left the bus after `lease_s`. The router of a system wants a `credential`.
        With `access` it raises BusError AOS608 for whatever the router would deny in silence.
        """
        config = client_config(endpoint, credential=credential, lease_s=lease_s)
        fault = _cannot_connect(endpoint, credential)
        session = await opened_session(config, connect_timeout_s, _RETRY_S, fault)
        return cls(session, sender, clock or SystemClock(), access)

    async def close(self) -> None:
        """Cancels running handlers, ends all streams, leaves the bus. Closing twice does nothing."""
        if self._is_closed:
            return
        self._is_closed = True
        for token in self._tokens.values():
            token.undeclare()
        await self._answers.close()
        for subscription in tuple(self._subscriptions):
            subscription.close()
        await asyncio.to_thread(self._session.close)

    async def ask(
        self,
        key: str,
        message: Message,
        reply: type[R],
        *,
        timeout_s: float,
        on_stray: Callable[[str, R | AosError], None] | None = None,
    ) -> R:
        """The answer of whoever serves `key`.

        NobodyAnswersError if nobody takes the question; LostAnswerError if whoever took it ended before the
        reply; LateAnswerError if no reply comes within `timeout_s`; BusError AOS602 or AOS603 if the reply is
        malformed or of another protocol version; the handler's own AosError if it raised one.
        """
        self._check("asks", key)
        payload = encode(message, sender=self.sender, stamp_ns=self._clock.now_ns())
        question = Question(key, reply, timeout_s, on_stray)
        hears_strays = on_stray is not None
        self._check_open()
        router = self.router
        self._session.get(
            key,
            question.replies,
            payload=payload,
            attachment=RECEIPT,
            timeout=timeout_s + STRAYS_S if hears_strays else timeout_s,
            # Not `express`: one question in ten whose answerer died was then never told to be lost.
            # Otherwise a reply is held back until every responder has finished.
            consolidation=zenoh.ConsolidationMode.NONE,
        )
        watch = ServerWatch(self._session, key)
        try:
            with suppress(TimeoutError):
                async with timeout(timeout_s if hears_strays else timeout_s + _LATE_S):
                    await self._wait_while_served(watch, question.settled, router)
        finally:
            question.settled.cancel()
            if not self._is_closed:
                watch.end()
        return question.answer()

    async def answer(self, key: str, request: type[M], handler: Handler[M]) -> None:
        """Serves `key` until the bus closes: `handler(message, key)` runs as a task for each question.

        Questions may overlap. An AosError of the handler goes to the asker with its code, any other exception
        as AOS606 and into the log. On return the key can be asked from anywhere.
        """
        self._check("answers", key)
        self._answers.begin(key, request, handler)
        await self._wait_for_router()

    def tell(self, key: str, message: Message) -> None:
        """Sends to whoever listens now. Nothing says whether it arrived: use it for what can be re-read."""
        self._check("tells", key)
        payload = encode(message, sender=self.sender, stamp_ns=self._clock.now_ns())
        self._check_open()
        self._session.put(key, payload, congestion_control=zenoh.CongestionControl.BLOCK)

    def listen(self, key: str, kind: type[M], *, queue_size: int = 1000) -> Subscription[tuple[str, M]]:
        """The messages told on `key` (which may hold wildcards), each with its own key.

        Messages that cannot be decoded are left out, and logged unless they are many.
        """
        self._check("hears", key)

        async def declare(subscription: Subscription[tuple[str, M]]) -> Undeclare:
            def on_payload(message_key: str, payload: bytes) -> None:
                try:
                    subscription.push((message_key, decode(payload, kind)))
                except BusError as error:
                    self._unread.count(message_key, f"on {message_key}: {error}")

            def on_sample(sample: zenoh.Sample) -> None:
                self._inbox.put(partial(on_payload, str(sample.key_expr), sample.payload.to_bytes()))

            subscriber = self._session.declare_subscriber(key, Callback(on_sample, indirect=False))
            await self._wait_for_router()
            self._subscriptions.add(subscription)
            return partial(self._end, subscription, subscriber)

        return Subscription(declare, queue_size)

    async def announce(self, key: str) -> None:
        """Makes `key` present until the bus closes or this process ends, however it ends."""
        self._check("announces", key)
        self._tokens[key] = self._session.liveliness().declare_token(key)
        await self._wait_for_router()

    def withdraw(self, key: str) -> None:
        """Ends the presence of `key`, if it was announced."""
        token = self._tokens.pop(key, None)
        if token is not None and not self._is_closed:
            token.undeclare()

    @property
    def instance(self) -> str:
        """A name that no other session on the bus has."""
        return str(self._session.zid())

    def presence(self, key_expression: str) -> Subscription[tuple[str, bool]]:
        """Watches which keys are present: (key, True) for each that is there or comes, (key, False) when it
        goes.

        Once entered, the keys already there are in the queue.
        """
        self._check("watches", key_expression)

        async def declare(subscription: Subscription[tuple[str, bool]]) -> Undeclare:
            presence = self._presence_of(key_expression)
            await self._wait_for_router()
            presence.follow(key_expression, subscription)
            self._subscriptions.add(subscription)
            return partial(self._leave, subscription, presence)

        return Subscription(declare, 1000)

    @property
    def is_routed(self) -> bool:
        """Says whether a router is there. The session finds back to one that is started again by itself."""
        return bool(self.router)

    @property
    def router(self) -> str:
        """The name of the router that is there, empty if none is; each start of a router has another name."""
        return "" if self._is_closed else " ".join(str(zid) for zid in self._session.info.routers_zid())

    async def has_lost_router(self, router: str) -> bool:
        """Says of a question whose answer was lost whether the router has gone, and not who was asked.

        `router` is the name of the one that was there when the question was asked.
        """
        await asyncio.sleep(_LINK_S)  # The session hears of its link a moment later.
        return not self.is_routed or self.router != router

    def _check(self, act: Act, key: str) -> None:
        if self._access is not None:
            self._access.check(act, key)

    def _presence_of(self, key_expression: str) -> Presence:
        """The presence of these keys. Who asks for one key hears of its siblings, and so do all others who
        ask for one of them."""
        for presence in self._presences:
            if presence.includes(key_expression):
                return presence
        siblings = f"{key_expression.rpartition('/')[0]}/*"
        is_allowed = self._access is None or self._access.allows("watches", siblings)
        widest = siblings if "*" not in key_expression and is_allowed else key_expression
        self._presences.append(Presence(self._session, self._inbox, widest))
        return self._presences[-1]

    def _check_open(self) -> None:
        if self._is_closed:
            raise BusError(f"{self.sender} has left the bus", code="AOS605")

    def _end(self, subscription: Subscription[Any], subscriber: zenoh.Subscriber[None]) -> None:
        self._subscriptions.discard(subscription)
        if not self._is_closed:
            subscriber.undeclare()

    def _leave(self, subscription: Subscription[tuple[str, bool]], presence: Presence) -> None:
        self._subscriptions.discard(subscription)
        presence.leave(subscription)

    async def _wait_for_router(self) -> None:
        """Returns when the router has taken in everything declared so far.

        A declaration returns before the router knows of it, and what another client sends meanwhile is lost;
        a round trip on the same link comes back after it.
        """
        for _ in range(_ROUND_TRIPS):
            if await self._has_gone_round():
                return
        raise BusError("the bus router does not answer", code="AOS605")

    async def _has_gone_round(self) -> bool:
        done = self._loop.create_future()
        self._session.liveliness().get(
            ROUND_TRIP,
            Callback(_ignore, partial(self._inbox.put, partial(_settle, done)), indirect=False),
            timeout=_ROUND_TRIP_S,
        )
        try:
            async with timeout(_ROUND_TRIP_S + _LATE_S):
                await done
        except TimeoutError:
            return False
        return True

    async def _wait_while_served(
        self, watch: ServerWatch, answer: asyncio.Future[tuple[bool, bytes] | None], router: str
    ) -> None:
        """Returns when `answer` is there; it is settled as lost once nobody serves its key, or once the
        router that has the question is gone: the next one knows nothing of it."""
        is_served = True
        while is_served:
            ends: set[asyncio.Future[Any]] = {answer, watch.has_left}
            pause_s = _UNANSWERED_S if watch.hears_of_leaving else _UNHEARD_S
            await asyncio.wait(ends, timeout=pause_s, return_when=asyncio.FIRST_COMPLETED)
            if answer.done():
                return
            has_other_router = self.router not in ("", router)
            is_served = not (watch.has_left.done() or has_other_router) and (
                not await self._has_gone_round() or watch.is_served
            )
        # An answer that was under way when its giver left comes first.
        await asyncio.wait({answer}, timeout=_UNANSWERED_S)
        if not answer.done():
            answer.set_result(None)


def _cannot_connect(endpoint: str, credential: Credential | None) -> BusError:
    """The error where no session opens: Zenoh tells a router that is not there from one that refuses by
    nothing."""
    hint = "Start a system with aos-up, or give the endpoint of the one that runs"
    if credential is None:
        refused = "or it lets nobody in without AOS_USER and AOS_PASSWORD_FILE"
    else:
        refused = f"or it knows no {credential.user} with this password"
    return BusError(f"no bus router answers at {endpoint}, {refused}", code="AOS605", hint=hint)


def _ignore(_: object) -> None:
    """Takes replies whose end alone matters."""


def _settle(future: asyncio.Future[None]) -> None:
    if not future.done():
        future.set_result(None)
