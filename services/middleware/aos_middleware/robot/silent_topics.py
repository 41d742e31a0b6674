"""Topics that mappings read and on which nothing has ever come, such as those whose name is misspelt."""

from collections import Counter
from collections.abc import Iterable, Mapping

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
