"""One question on the bus: its receipt, its reply, and the replies that come when nobody waits any more."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar

import zenoh
from zenoh.handlers import Callback

from aos_protocol.codec import decode, decode_fault
from aos_protocol.errors import AosError, BusError, LateAnswerError, LostAnswerError, NobodyAnswersError
from aos_protocol.messages import Message

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
