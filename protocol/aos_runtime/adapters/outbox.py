"""The messages of an adapter that wait to be sent, from any thread, in order."""

import asyncio
import logging
import threading
from collections import Counter, deque
from typing import Any

from aos_protocol.errors import SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import TopicMessage
from aos_runtime.adapters.sendable import sendable
from aos_runtime.bus.bus import Bus

MAX_UNSENT_MESSAGES = 10_000
"""The oldest topic messages give way where more than these wait to be sent."""

_log = logging.getLogger("aos.adapter")


class Outbox:
    """Sends topic messages from the thread of the running event loop, numbered for each topic."""

    def __init__(self, bus: Bus, keys: Keys) -> None:
        self._bus = bus
        self._keys = keys
        self._loop = asyncio.get_running_loop()
        self._sent: Counter[str] = Counter()
        self._unsent: deque[tuple[str, dict[str, Any]]] = deque(maxlen=MAX_UNSENT_MESSAGES)
        self._sending = threading.Lock()
        self._is_sending = False
        self._giving_way: Counter[str] = Counter()
        self.lost: Counter[str] = Counter()
        """The number of messages so far on each topic that gave way and were never sent."""

    @property
    def sent(self) -> dict[str, int]:
        """The number of messages so far on each topic."""
        return dict(self._sent)

    def publish(self, topic: str, fields: dict[str, Any]) -> None:
        """Sends a message on a topic. From any thread, in order.

        SkillError AOS510 if the topic is no text, or a field is nothing that the bus can carry.
        """
        if not isinstance(topic, str):
            raise SkillError(f"the topic {topic!r} is no text", code="AOS510")
        fields = sendable(fields, f"a message on {topic}")
        with self._sending:
            if len(self._unsent) == MAX_UNSENT_MESSAGES:
                self._giving_way[self._unsent[0][0]] += 1
            self._unsent.append((topic, fields))
            is_first, self._is_sending = not self._is_sending, True
        if is_first:
            self._loop.call_soon_threadsafe(self.send)

    def send(self) -> None:
        """Sends what waits, numbered for each topic; what comes meanwhile goes with the next turn."""
        with self._sending:
            waiting, self._is_sending = list(self._unsent), False
            self._unsent.clear()
            lost, self._giving_way = self._giving_way, Counter()
        for topic, fields in waiting:
            self._sent[topic] += 1
            self._bus.tell(self._keys.topic(topic), TopicMessage(self._sent[topic], fields))
        for topic, number in lost.items():
            _log.warning("%d messages on %s came too fast to be sent", number, topic)
        self.lost = self.lost + lost
