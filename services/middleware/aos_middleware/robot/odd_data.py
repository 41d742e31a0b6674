"""Odd data of the robot, told once: topics on which nothing ever came, and numbers that are not finite."""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from aos_protocol.spelling import did_you_mean

CALLS = 3
"""A topic that was silent during this many calls of skills is told."""


class SilentTopics:
    """Counts the calls during which a topic was silent, and tells each one once.

    A mapping with an initial value goes on without a message: nothing else tells that none comes.
    """

    def __init__(self) -> None:
        self._calls: Counter[str] = Counter()
        self._heard: set[str] = set()

    def take_call(self, has_heard: Mapping[str, bool], sent: Iterable[str]) -> list[str]:
        """Returns what is to be told after a call: of each topic, whether a message has come on it.

        `sent` are the topics on which adapters have sent something.
        """
        notices = []
        self._heard |= {topic for topic, is_heard in has_heard.items() if is_heard}
        for topic in has_heard.keys() - self._heard:
            self._calls[topic] += 1
            if self._calls[topic] == CALLS:
                known = [f"/{name.strip('/')}" for name in sent]
                is_sent = f"/{topic.strip('/')}" in known
                unsent = did_you_mean(topic, known) or "No adapter has sent on it"
                hint = "They come between calls" if is_sent else unsent
                notices.append(f"no message has come on {topic} in {CALLS} calls of skills. {hint}")
        return notices


_NAN = "NaN compares as false in rules: tell it apart in a first rule, as by `x != x`"
_INFINITE = "It lies beyond all limits of rules: tell it apart in a first rule, as by `abs(x) > 1e300`"


class OddNumbers:
    """Tells once of each field of results and messages that was NaN or infinite.

    Lists are left out: ranges of a scanner are infinite where nothing is in reach.
    """

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()

    def take(self, what: str, fields: Mapping[str, Any]) -> list[str]:
        """Returns what is to be told of these fields; `what` says of what they are."""
        notices = []
        for field, number in _not_finite(fields):
            if (what, field) not in self._told:
                self._told.add((what, field))
                hint = _NAN if math.isnan(number) else _INFINITE
                notices.append(f"{field} of {what} is {number}, no finite number. {hint}")
        return notices


def _not_finite(fields: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    for name, value in fields.items():
        if isinstance(value, float) and not math.isfinite(value):
            yield f"{before}{name}", value
        elif isinstance(value, Mapping):
            yield from _not_finite(value, f"{before}{name}.")
