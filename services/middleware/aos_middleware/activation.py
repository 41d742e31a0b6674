"""One activation: from parameters to the call, from what happened to the observation.

Order of effect: fields of the call from the parameters; topics are listened to; the call; every topic
message that was sent before the call ended; the result; the rules. Nothing of one activation reaches the
next.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Any, NamedTuple

import msgspec

from aos_middleware.evaluator import Evaluator, MappingFault
from aos_middleware.low_level import LowLevelValues, assigned_variables
from aos_middleware.monitors import Monitored, Monitors
from aos_middleware.motion_gate import GONE_S, MotionGate
from aos_middleware.no_response import no_response
from aos_middleware.observed_numbers import observed_numbers
from aos_middleware.served_paths import ServedPaths, no_adapter
from aos_middleware.stopping import Stop
from aos_protocol.documents import AbstractionMapping, LocalSource
from aos_protocol.errors import AosError, LateAnswerError, LostAnswerError, NobodyAnswersError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    Activate,
    Cancel,
    Cancelled,
    Fault,
    Outcome,
    SkillCall,
    SkillResult,
    Stray,
    TopicMessage,
)
from aos_runtime.asking import AWAY_S
from aos_runtime.bus import Bus, Subscription
from aos_runtime.clock import Clock
from aos_runtime.failpoints import reach
from aos_runtime.subscription import merged

__all__ = ["Surroundings", "refused", "run_activation"]

CATCH_UP_S = 0.5
"""An activation waits so long, after the call, for topic messages that were sent during it."""

_REPLY_GRACE_S = 0.2
_CANCEL_S = 0.25
"""An activation that is late waits so long for word that its skill has stopped; the next one waits on."""

_BATCH = 256
_QUEUE_SIZE = 4096

_log = logging.getLogger("aos.middleware")


class Surroundings(NamedTuple):
    """The outside of an activation: the bus, the robot's keys, the time.

    `published` is what had been sent on each topic when the last call ended; each activation updates it.
    `low_level` holds the values that responses have given. `on_stray` is told of replies that are not used.
    `is_played` says whether the skill at a path is played by its document.
    """

    bus: Bus
    keys: Keys
    clock: Clock
    published: dict[str, int]
    low_level: LowLevelValues
    served: ServedPaths
    gate: MotionGate
    on_stray: Callable[[Stray], None]
    is_played: Callable[[str], bool]
    monitors: Monitors


class _Observation(msgspec.Struct, frozen=True):
    """The gain of an activation: see `Outcome`. `failure` is why the skill failed, where a rule tells it."""

    response: str = ""
    local_variables: dict[str, str] = {}
    assigned: dict[str, Any] = {}
    numbers: dict[str, Any] = {}
    failure: AosError | None = None
    stopped_by: str = ""


async def run_activation(
    request: Activate, evaluator: Evaluator, around: Surroundings, *, is_taken_up: bool = False
) -> Outcome:
    """Runs an activation within its deadline and returns how it ended. Whatever goes wrong is in the outcome.

    An activation `is_taken_up` that a middleware had begun which is gone. It joins the call that still runs.
    Where its mapping reads topics, their messages were missed, and the outcome is `unknown`.
    """
    started_ns = around.clock.now_ns()
    observation = _Observation()
    fault: AosError | None = None
    status = "observed"
    activation = _Activation(request, evaluator, around, is_taken_up)
    await around.monitors.begin(activation.stop)
    told = Monitored({}, {})
    try:
        observation = await activation.run()
    except MappingFault as error:
        fault, observation = error, _Observation(local_variables=error.local_variables)
        # A skill that was called may have done its work: its mapping has failed, not the robot.
        status = "unknown" if activation.was_called else "failed"
    except AosError as error:
        fault, status = error, error.status
    finally:
        told = await around.monitors.end(activation.stop)
    cause = fault or observation.failure
    return Outcome(
        request.id,
        request.skill,
        status,
        observation.response,
        observation.local_variables,
        started_ns=started_ns,
        ended_ns=around.clock.now_ns(),
        fault=None if cause is None else _fault_of(cause),
        assigned=observation.assigned,
        numbers=observation.numbers,
        stopped_by=observation.stopped_by,
        monitors=told.responses | activation.played_monitors,
        monitor_faults=told.faults,
    )


def refused(request: Activate, error: AosError, now_ns: int) -> Outcome:
    """The outcome of an activation that nothing was begun for."""
    return Outcome(
        request.id, request.skill, "refused", started_ns=now_ns, ended_ns=now_ns, fault=_fault_of(error)
    )


def _fault_of(error: AosError) -> Fault:
    """An exception as a message."""
    return Fault(error.code, error.message, error.hint, error.diagnostics)


def _missed_topics(request: Activate) -> SkillError:
    return SkillError(
        f"middleware or router were started again while {request.skill} ran, and its topics were missed",
        code="AOS504",
        hint="The skill has ended; let the robot sense what became of it",
    )


class _Activation:
    """The steps of one activation and what they share: the deadline, and which messages were seen."""

    def __init__(
        self, request: Activate, evaluator: Evaluator, around: Surroundings, is_taken_up: bool
    ) -> None:
        self._request = request
        self._evaluator = evaluator
        self._around = around
        self._bus, self._keys, self._clock = around.bus, around.keys, around.clock
        self._published_before, self._low_level = around.published, around.low_level
        self._mapping: AbstractionMapping = evaluator.emitted.mapping
        self._ends_at_s = self._clock.monotonic_s() + request.deadline_s
        self._topic_of = {
            self._keys.topic(variable.topic): variable.topic
            for variable in self._mapping.local_variables
            if variable.source is LocalSource.TOPIC
        }
        self._last_numbers: dict[str, int] = {}
        self._has_received = asyncio.Event()
        self._fault: AosError | None = None
        self.stop = Stop(around.bus, around.keys, request, self._mapping.activation.path)
        self.was_called = False
        self.played_monitors: dict[str, str] = {}
        self._has_missed = is_taken_up

    async def run(self) -> _Observation:
        """Calls the skill with its fields and returns what is observed."""
        fields = await self._fields()
        try:
            result = await self._listening_call(fields)
        except MappingFault:
            raise
        except AosError as error:
            if self.stop.is_cause(error):
                return await self._observed_stop(error)
            if not self._evaluator.emitted.handles_failures:
                raise
            return await self._observed_failure(error)
        self.played_monitors = result.monitors
        if result.response:
            return _Observation(result.response, numbers=result.numbers)
        if self._has_missed and self._topic_of:
            raise _missed_topics(self._request)
        observed = await self._evaluator.finish(result.fields)
        if observed.response is None:
            raise no_response(self._mapping, result.fields, observed.local_variables)
        return _Observation(
            observed.response,
            observed.local_variables,
            assigned_variables(observed.assigned, self._request),
            observed_numbers(self._evaluator.emitted.observed, observed.local_variables),
        )

    async def _fields(self) -> dict[str, Any]:
        """The fields of the call from the parameters; none where that fails and the adapter needs none."""
        constants = self._evaluator.emitted.constants
        try:
            return await self._evaluator.begin(*self._low_level.arguments(self._request, constants))
        except MappingFault as error:
            if not self._around.is_played(self._mapping.activation.path):
                raise
            _log.warning("%s is played without the fields of its call: %s", self._request.skill, error)
            return {}

    async def _observed_failure(self, error: AosError) -> _Observation:
        """Returns what the rules make of a skill that has failed; raises the skill's error where none of
        them holds."""
        try:
            observed = await self._evaluator.finish({}, error.status, error.message)
        except MappingFault as fault:
            _log.warning("%s: the rules say nothing about its failure: %s", self._request.skill, fault)
            raise error from fault
        if observed.response is None:
            raise error
        return _Observation(
            observed.response,
            observed.local_variables,
            assigned_variables(observed.assigned, self._request),
            failure=error,
        )

    async def _observed_stop(self, error: AosError) -> _Observation:
        """Returns what the rules make of a skill that `stop_when` has stopped, which is no failure."""
        if self._has_missed:
            raise _missed_topics(self._request)
        observed = await self._evaluator.finish({}, "stopped", self.stop.reason)
        if observed.response is None:
            raise self.stop.unexplained(error)
        return _Observation(
            observed.response,
            observed.local_variables,
            assigned_variables(observed.assigned, self._request),
            observed_numbers(self._evaluator.emitted.observed, observed.local_variables),
            stopped_by=self.stop.by,
        )

    async def _listening_call(self, fields: dict[str, Any]) -> SkillResult:
        """Calls the skill while topic messages are evaluated.

        Mapping code that fails during the call does not end the call: the skill may be moving.
        """
        result: SkillResult | None = None
        streams = [self._bus.listen(key, TopicMessage) for key in sorted(self._topic_of)]
        async with merged(*streams, queue_size=_QUEUE_SIZE) as messages, asyncio.TaskGroup() as tasks:
            tasks.create_task(self._take(messages))
            stopping = tasks.create_task(self.stop.follow())
            try:
                result = await self._call(fields)
                await self._catch_up(result)
            except AosError as error:
                self._fault = error
            finally:
                stopping.cancel()
                messages.close()
        if messages.dropped:
            _log.warning("%s: %d topic messages came too fast", self._request.skill, messages.dropped)
        if self._fault is not None:
            raise self._fault
        assert result is not None
        return result

    async def _call(self, fields: dict[str, Any]) -> SkillResult:
        path = self._mapping.activation.path
        if self._around.served.announced(path):
            # After the router, its clients are back within a moment.
            await self._around.served.is_back(path, GONE_S)
        if fault := self._around.served.fault(path):
            raise fault
        with self._around.gate.passing(path):
            await self._around.gate.confirm()
            self.stop.let_out()
            return await self._call_path(path, fields)

    async def _call_path(self, path: str, fields: dict[str, Any]) -> SkillResult:
        """The answer to the call; there is doubt whether it has ended unless the adapter says that it has."""
        request = self._request
        self.was_called = True
        started_s = self._clock.monotonic_s()
        limit_s = max(self._ends_at_s - started_s, 0.0)
        if self._mapping.activation.max_duration_s is not None:
            limit_s = min(limit_s, self._mapping.activation.max_duration_s)
        call = SkillCall(request.id, path, fields, limit_s, request.skill, request.parameters, request.epoch)
        has_ended = False
        try:
            result = await self._answer(path, call)
            has_ended = result.id == request.id
        except LateAnswerError as error:
            has_ended = await self._cancel(f"{request.skill} did not end within {limit_s:g} s")
            raise _timed_out(path, limit_s) from error
        except LostAnswerError as error:
            raise _lost_adapter(path, self._clock.monotonic_s() - started_s) from error
        except NobodyAnswersError as error:
            # One that ends at once may have begun before its receipt went out.
            after_s = self._clock.monotonic_s() - started_s
            was_there = await self._around.served.has_left(path, GONE_S)
            raise (_lost_adapter(path, after_s) if was_there else no_adapter(path)) from error
        except SkillError as error:
            has_ended = error.status != "unknown"
            raise
        finally:
            if not has_ended:
                self._around.gate.doubt(request, path)
        if not has_ended:
            self._note_stray("foreign", result)
            raise SkillError(
                f"the adapter of {path} answered for {result.id}, not for {request.id}",
                code="AOS504",
                hint="Mend the adapter: a result has the id of its call",
            )
        return result

    async def _answer(self, path: str, call: SkillCall) -> SkillResult:
        """Returns the adapter's answer; the call is asked for again where the router has gone."""
        limit_s = call.deadline_s + _REPLY_GRACE_S
        while True:
            router = self._bus.router
            reach("middleware.call.before")
            try:
                result = await self._bus.ask(
                    self._keys.call(path), call, SkillResult, timeout_s=limit_s, on_stray=self._note_stray
                )
            except (LostAnswerError, NobodyAnswersError):
                if not await self._bus.has_lost_router(router):
                    raise
                self._has_missed = True
                if not await self._around.served.is_back(path, AWAY_S):
                    raise
                _log.info("%s is asked again, since the router was away", path)
            else:
                reach("middleware.call.after")
                return result

    async def _cancel(self, reason: str) -> bool:
        """Has the skill stopped; whether its adapter says that it has."""
        cancel = Cancel(reason, self._request.id, self._request.epoch)
        key = self._keys.cancel(self._mapping.activation.path)
        try:
            await self._bus.ask(key, cancel, Cancelled, timeout_s=_CANCEL_S)
        except AosError as error:
            _log.warning("%s, and nobody says that it has stopped: %s", reason, error)
            return False
        return True

    def _note_stray(self, kind: str, reply: SkillResult | AosError) -> None:
        """A reply that is not used is kept for people."""
        path, request = self._mapping.activation.path, self._request
        text = str(reply) if isinstance(reply, AosError) else f"a result for {reply.id}"
        _log.warning("%s: a %s reply for %s is not used: %s", path, kind, request.id, text)
        self._around.on_stray(Stray(request.id, path, kind, text))

    async def _take(self, messages: Subscription[tuple[str, TopicMessage]]) -> None:
        """Evaluates topic messages until the stream is closed and empty."""
        async for first in messages:
            batch = [first]
            while messages.has_items and len(batch) < _BATCH:
                batch.append(await anext(messages))
            await self._evaluate([(self._topic_of[key], message.fields) for key, message in batch])
            for key, message in batch:
                self._last_numbers[key] = message.number
            self._has_received.set()

    async def _evaluate(self, messages: list[tuple[str, dict[str, Any]]]) -> None:
        """Hands messages over to mapping code, and has the skill stopped where one of them says so."""
        while messages and self._fault is None:
            try:
                taken = await self._evaluator.take(messages)
            except AosError as error:
                self._fault = error
                _log.warning("%s goes on, but its mapping failed: %s", self._request.skill, error)
                return
            if taken.stops:
                self.stop.ask(self._request.skill)
            messages = messages[max(taken.messages, 1) :]

    async def _catch_up(self, result: SkillResult) -> None:
        """Waits until every message that the adapter had sent when the call ended has been evaluated."""
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
        try:
            async with asyncio.timeout(CATCH_UP_S):
                while any(self._last_numbers.get(key, 0) < number for key, number in sent.items()):
                    self._has_received.clear()
                    await self._has_received.wait()
        except TimeoutError:
            for key, number in sent.items():
                _log.info("%s: message %d did not come, seen %d", key, number, self._last_numbers.get(key, 0))
        await self._around.monitors.catch_up(spoken, CATCH_UP_S)


def _timed_out(path: str, limit_s: float) -> SkillError:
    return SkillError(
        f"the skill at {path} did not answer within {limit_s:g} s",
        code="AOS503",
        hint="See the skill's log; its time is the mapping's `max_duration` or the mission's limit",
    )


def _lost_adapter(path: str, after_s: float) -> SkillError:
    return SkillError(
        f"the adapter of {path} was lost {after_s:.1f} s after it was called",
        code="AOS504",
        hint="Whether the skill did its work is not known",
    )
