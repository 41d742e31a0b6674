"""The messages of an adapter that wait to be sent, from any thread, in order, with values made ready."""

import asyncio
import logging
import threading
import time
from collections import Counter, deque
from collections.abc import Mapping
from typing import Any

import msgspec

from aos_protocol.codec import MAX_BYTES
from aos_protocol.errors import BusError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import TopicMessage
from aos_runtime.bus.bus import Bus
from aos_runtime.plain_data import plain_from

MAX_UNSENT_MESSAGES = 10_000
"""The oldest topic messages give way where more than these wait to be sent."""

_TURN_S = 0.02
"""Sending may hold up calls for so long. A thread that never rests makes each message slow."""
_TOLD_AGAIN_S = 1.0

_log = logging.getLogger("aos.adapter")


class Outbox:
    """Sends topic messages from the thread of the running event loop, numbered for each topic."""

    def __init__(self, bus: Bus, keys: Keys) -> None:
        self._bus = bus
        self._keys = keys
        self._loop = asyncio.get_running_loop()
        self._sent: Counter[str] = Counter()
        self._unsent: deque[tuple[str, str, dict[str, Any]]] = deque(maxlen=MAX_UNSENT_MESSAGES)
        self._sending = threading.Lock()
        self._is_sending = False
        self._giving_way: Counter[str] = Counter()
        self._untold: Counter[str] = Counter()
        self._told_s = 0.0
        self.lost: Counter[str] = Counter()
        """The number of messages so far on each topic that gave way and were never sent."""

    @property
    def sent(self) -> dict[str, int]:
        """The number of messages so far on each topic."""
        return dict(self._sent)

    def publish(self, topic: str, fields: dict[str, Any]) -> None:
        """Sends a message on a topic. From any thread, in order.

        SkillError AOS510 if the topic is no name of one, or a field is nothing that the bus can carry.
        """
        if not isinstance(topic, str):
            raise SkillError(f"the topic {topic!r} is no text", code="AOS510")
        try:
            key = self._keys.topic(topic)
        except BusError as error:
            message = f"no topic has such a name: {error.message}"
            raise SkillError(message, code="AOS510", hint=error.hint) from error
        fields = sendable(fields, f"a message on {topic}")
        with self._sending:
            if len(self._unsent) == MAX_UNSENT_MESSAGES:
                self._giving_way[self._unsent[0][0]] += 1
            self._unsent.append((topic, key, fields))
            is_first, self._is_sending = not self._is_sending, True
        if is_first:
            self._loop.call_soon_threadsafe(self._send_some)

    def send(self) -> None:
        """Sends all that waits; what comes meanwhile goes with the next turn."""
        with self._sending:
            waiting = len(self._unsent)
        for _ in range(waiting):
            self._send_oldest()
        self._note_lost(tells=True)

    def _send_some(self) -> None:
        """Sends one message, and more for the time of a turn."""
        ends_s = time.monotonic() + _TURN_S
        while self._send_oldest() and time.monotonic() < ends_s:
            pass
        with self._sending:
            goes_on = self._is_sending = bool(self._unsent)
        self._note_lost(tells=not goes_on or time.monotonic() - self._told_s >= _TOLD_AGAIN_S)
        if goes_on:
            self._loop.call_soon(self._send_some)

    def _send_oldest(self) -> bool:
        with self._sending:
            if not self._unsent:
                return False
            topic, key, fields = self._unsent.popleft()
        self._sent[topic] += 1
        self._bus.tell(key, TopicMessage(self._sent[topic], fields))
        return True

    def _note_lost(self, tells: bool) -> None:
        with self._sending:
            lost, self._giving_way = self._giving_way, Counter()
        self.lost = self.lost + lost
        self._untold += lost
        if self._untold and tells:
            for topic, number in self._untold.items():
                _log.warning("%d messages on %s came too fast to be sent", number, topic)
            self._untold, self._told_s = Counter(), time.monotonic()


_encoder = msgspec.msgpack.Encoder()


def sendable(fields: Mapping[str, Any], what: str) -> dict[str, Any]:
    """The fields as plain data, such as a list for a numpy array.

    SkillError AOS510 names the field that the bus cannot carry; `what` says of what it is.
    """
    plain: dict[str, Any] = {}
    size_bytes = 0
    for name, value in fields.items():
        try:
            plain[str(name)] = plain_from(value)
            size_bytes += len(_encoder.encode(plain[str(name)]))
        except Exception as error:  # Whatever a property of somebody's class raises.
            raise SkillError(
                f"the field {name} of {what} cannot be sent: {error}",
                code="AOS510",
                hint="Give numbers, texts, bytes, lists and dicts of them, or numpy's arrays",
            ) from error
    if size_bytes > MAX_BYTES:
        hint = "Give less, such as a smaller picture"
        message = f"{what} has {size_bytes} bytes, and the bus carries {MAX_BYTES}"
        raise SkillError(message, code="AOS510", hint=hint)
    return plain
