"""The topics of one activation: each message that was sent before its call ended is evaluated, in order."""

import asyncio
import logging
from contextlib import suppress
from typing import Any

from aos_middleware.activations.surroundings import Surroundings
from aos_middleware.robot.stopping import Stop
from aos_middleware.workers.evaluator import Evaluator, MappingFault
from aos_protocol.documents import LocalSource
from aos_protocol.errors import AosError
from aos_protocol.messages import SkillResult, TopicMessage
from aos_runtime.bus.bus import Subscription

CATCH_UP_S = 0.5
"""An activation waits so long, after the call, for topic messages that were sent during it.

As long it waits for a first one where a variable has no value without it: a node of ROS sends what it
publishes beside its answer, and later.
"""

EVALUATE_S = 5.0
"""Messages of a call are evaluated for so long after its end; then the mapping has failed."""

QUEUE_SIZE = 4096

_log = logging.getLogger("aos.middleware")


class HeardTopics:
    """The topics that a mapping reads, by the `keys` to listen to.

    `fault` is why no message is evaluated any more; None while they are.
    """

    def __init__(self, skill: str, evaluator: Evaluator, around: Surroundings, stop: Stop) -> None:
        self.fault: AosError | None = None
        self._skill = skill
        self._evaluator = evaluator
        self._around = around
        self._published_before = around.published
        self._stop = stop
        heard = [
            variable
            for variable in evaluator.emitted.mapping.local_variables
            if variable.source is LocalSource.TOPIC
        ]
        self._span = heard[0].span if heard else evaluator.emitted.mapping.span
        self._topic_of = {around.keys.topic(variable.topic): variable.topic for variable in heard}
        self._awaited = {
            around.keys.topic(variable.topic) for variable in heard if variable.initial_value is None
        }
        self._last_numbers: dict[str, int] = {}
        self._odd: list[str] = []
        self._has_received = asyncio.Event()

    @property
    def keys(self) -> list[str]:
        return sorted(self._topic_of)

    async def take(self, messages: Subscription[tuple[str, TopicMessage]]) -> None:
        """Evaluates topic messages until the stream is closed and empty."""
        async for batch in messages.batches():
            await self._evaluate([(self._topic_of[key], message.fields) for key, message in batch])
            for key, message in batch:
                self._last_numbers[key] = message.number
                self._odd += self._around.odd.take(self._topic_of[key], message.fields)
            self._has_received.set()

    async def finish(self, taking: asyncio.Task[None]) -> None:
        """Waits until all that came before the call ended has been evaluated. The solver waits, too."""
        _, late = await asyncio.wait({taking}, timeout=EVALUATE_S)
        if late:
            taking.cancel()
            topics = " and ".join(self._topic_of.values())
            message = f"messages on {topics} come faster than code evaluates them"
            hint = "Have them sent less often, or the code do less for each"
            self.fault = self.fault or MappingFault(message, self._span, code="AOS403", hint=hint)

    async def _evaluate(self, messages: list[tuple[str, dict[str, Any]]]) -> None:
        """Hands messages over to mapping code, and has the skill stopped where one of them says so."""
        while messages and self.fault is None:
            try:
                taken = await self._evaluator.take(messages)
            except AosError as error:
                self.fault = error
                _log.warning("%s goes on, but its mapping failed: %s", self._skill, error)
                return
            if taken.stops:
                self._stop.ask(self._skill)
            messages = messages[max(taken.messages, 1) :]

    async def catch_up(self, result: SkillResult) -> None:
        """Waits a while for what the adapter had sent when the call ended to come, and to be evaluated."""
        published = {path.strip("/"): number for path, number in result.published.items()}
        # An unchanged number: the topic was silent, and there is nothing to wait for.
        before = self._published_before
        spoken = {topic: number for topic, number in published.items() if number != before.get(topic, 0)}
        before.update(published)
        sent = {
            key: spoken[topic.strip("/")]
            for key, topic in self._topic_of.items()
            if topic.strip("/") in spoken
        }
        first = set() if result.response else self._awaited  # A skill that its document plays sends nothing.
        with suppress(TimeoutError):
            async with asyncio.timeout(CATCH_UP_S):
                while (first - self._last_numbers.keys()) or any(
                    self._last_numbers.get(key, 0) < number for key, number in sent.items()
                ):
                    self._has_received.clear()
                    await self._has_received.wait()
        await self._around.monitors.catch_up(spoken, CATCH_UP_S)

    def notices(self, result: SkillResult) -> list[str]:
        """Returns what is to be told of the topics, now that all that came has been evaluated."""
        if result.response:
            return []
        lost = {path.strip("/"): number for path, number in result.lost.items()}
        for topic in self._topic_of.values():
            if number := lost.get(topic.strip("/")):
                fast = f"{number:,} messages on {topic} came too fast for the adapter to send them"
                self._odd.append(f"{self._skill}: {fast}, the oldest of the call")
        own = {topic: key in self._last_numbers for key, topic in self._topic_of.items()}
        return self._odd + self._around.silent.take_call(
            self._around.monitors.has_heard() | own, result.published
        )
