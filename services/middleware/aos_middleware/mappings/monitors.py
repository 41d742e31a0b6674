"""The monitors of a project: mappings without a skill, at work as long as the middleware is.

What a monitor has heard since the outcome before becomes one response with the next outcome. A `stop_when`
that becomes true stops what runs, or what would be called next where nothing runs.
"""

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from aos_middleware.robot.stopping import Stop
from aos_middleware.workers.evaluator import Evaluator
from aos_protocol.documents import LocalSource
from aos_protocol.errors import AosError
from aos_protocol.keys import Keys
from aos_protocol.messages import TopicMessage
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.subscription import merged

LISTEN_S = 5.0
"""An activation waits this long for new monitors to be at work."""

EVALUATE_S = 5.0
"""An outcome waits so long for what a monitor has heard to be evaluated."""

_QUEUE_SIZE = 4096

_log = logging.getLogger("aos.middleware")


class Monitored(NamedTuple):
    """The responses of monitors, and why others gave none, by monitor."""

    responses: dict[str, str]
    faults: dict[str, str]


class Monitors:
    """Runs the monitors of the newest mappings, and tells their responses."""

    def __init__(self, bus: Bus, keys: Keys) -> None:
        self._bus = bus
        self._keys = keys
        self._running: dict[str, _Monitor] = {}
        self._leaving: list[_Monitor] = []
        self._has_changed = asyncio.Event()
        self._stops: list[Stop] = []

    def follow(self, evaluators: Mapping[str, Evaluator]) -> None:
        """These are the monitors from now on, by name."""
        for name, monitor in list(self._running.items()):
            if evaluators.get(name) is not monitor.evaluator:
                self._leaving.append(self._running.pop(name))
        for name, evaluator in evaluators.items():
            if name not in self._running:
                self._running[name] = _Monitor(name, evaluator, self._on_stop)
        self._has_changed.set()

    async def run(self) -> None:
        """Keeps the monitors listening that are wanted."""
        listening: dict[_Monitor, asyncio.Task[None]] = {}
        async with asyncio.TaskGroup() as tasks:
            while True:
                self._has_changed.clear()
                for monitor in self._leaving:
                    if monitor in listening:
                        listening.pop(monitor).cancel()
                self._leaving.clear()
                for monitor in self._running.values():
                    if monitor not in listening:
                        listening[monitor] = tasks.create_task(monitor.listen(self._bus, self._keys))
                await self._has_changed.wait()

    async def begin(self, stop: Stop) -> None:
        """Returns when all monitors listen: an activation begins. It is stopped where a monitor has said so
        and no outcome has told of it."""
        self._stops.append(stop)
        try:
            async with asyncio.timeout(LISTEN_S):
                for monitor in list(self._running.values()):
                    await monitor.listens.wait()
        except TimeoutError:
            _log.warning("the monitors do not listen yet")
        for monitor in self._running.values():
            if monitor.has_risen:
                stop.ask(monitor.name)

    async def catch_up(self, sent: Mapping[str, int], within_s: float) -> None:
        """Waits until the messages with these numbers have been evaluated, by topic without its slash."""
        try:
            async with asyncio.timeout(within_s):
                for monitor in list(self._running.values()):
                    await monitor.until_heard(sent)
        except TimeoutError:
            _log.info("monitors: some messages did not come")

    def has_heard(self) -> dict[str, bool]:
        """The topics of the monitors, and of each whether a message has come on it."""
        return {
            topic: topic.strip("/") in monitor.last_numbers
            for monitor in self._running.values()
            for topic in monitor.topics
        }

    async def end(self, stop: Stop) -> Monitored:
        """The activation has ended: what the monitors have heard since the one before."""
        self._stops.remove(stop)
        told = Monitored({}, {})
        for name, monitor in sorted(self._running.items()):
            response, fault = await monitor.response()
            if response:
                told.responses[name] = response
            if fault:
                told.faults[name] = fault
        return told

    def _on_stop(self, monitor: str) -> None:
        for stop in self._stops:
            stop.ask(monitor)


class _Monitor:
    """One monitor. `has_risen` says that its `stop_when` became true since its last response, and `listens`
    that it is at work. `last_numbers` are those of the last messages, by topic without its slash."""

    def __init__(self, name: str, evaluator: Evaluator, on_stop: Callable[[str], None]) -> None:
        self.name = name
        self.evaluator = evaluator
        self.has_risen = False
        self.listens = asyncio.Event()
        self._on_stop = on_stop
        self.topics = {
            variable.topic
            for variable in evaluator.emitted.mapping.local_variables
            if variable.source is LocalSource.TOPIC
        }
        self._asking = asyncio.Lock()
        self._has_heard = False
        self._fault = ""
        self.last_numbers: dict[str, int] = {}
        self._received = asyncio.Event()

    async def listen(self, bus: Bus, keys: Keys) -> None:
        """Evaluates the messages of its topics for ever; meanwhile nobody else closes its worker."""
        topics = {keys.topic(topic): topic for topic in sorted(self.topics)}
        streams = [bus.listen(key, TopicMessage) for key in topics]
        async with self.evaluator.in_use, merged(*streams, queue_size=_QUEUE_SIZE) as messages:
            async with self._asking:
                await self._begin()
            self.listens.set()
            async for batch in messages.batches():
                async with self._asking:
                    await self._evaluate([(topics[key], message.fields) for key, message in batch])
                for key, message in batch:
                    self.last_numbers[topics[key].strip("/")] = message.number
                self._received.set()

    async def until_heard(self, sent: Mapping[str, int]) -> None:
        """Returns when the messages with these numbers have been evaluated."""
        own = [topic.strip("/") for topic in self.topics if topic.strip("/") in sent]
        while any(self.last_numbers.get(topic, 0) < sent[topic] for topic in own):
            self._received.clear()
            await self._received.wait()

    async def response(self) -> tuple[str, str]:
        """The response to what it has heard since the last one, and why there is none; empty for nothing."""
        try:
            async with asyncio.timeout(EVALUATE_S):
                await self._asking.acquire()
        except TimeoutError:
            return "", "its messages come faster than its code evaluates them"
        try:
            self.has_risen = False
            fault, self._fault = self._fault, ""
            if fault or not self._has_heard:
                self._has_heard = False
                return "", fault
            self._has_heard = False
            try:
                return (await self.evaluator.finish({})).response or "", ""
            except AosError as error:
                await self._begin()
                return "", str(error)
        finally:
            self._asking.release()

    async def _begin(self) -> None:
        try:
            await self.evaluator.begin({})
        except AosError as error:
            self._fault = str(error)
            _log.warning("the monitor %s cannot begin: %s", self.name, error)

    async def _evaluate(self, messages: list[tuple[str, dict[str, Any]]]) -> None:
        while messages:
            try:
                taken = await self.evaluator.take(messages)
            except AosError as error:
                self._fault = str(error)
                _log.warning("the monitor %s begins anew: %s", self.name, error)
                return await self._begin_after_fault()
            self._has_heard = True
            if taken.stops:
                self.has_risen = True
                self._on_stop(self.name)
            messages = messages[max(taken.messages, 1) :]

    async def _begin_after_fault(self) -> None:
        fault = self._fault
        await self._begin()
        self._fault = fault
