"""One activation: from parameters to the call, from what happened to the observation.

Order of effect: fields of the call from the parameters; topics are listened to; the call; every topic
message that was sent before the call ended; the result; the rules. Nothing of one activation reaches the
next.
"""

import asyncio
import logging
import math
from collections.abc import Iterable, Mapping
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_middleware.activations.heard_topics import QUEUE_SIZE, HeardTopics
from aos_middleware.activations.skill_call import Call
from aos_middleware.activations.surroundings import Surroundings
from aos_middleware.mappings.low_level import assigned_variables
from aos_middleware.mappings.monitors import Monitored
from aos_middleware.robot.stopping import Stop
from aos_middleware.workers.evaluator import Evaluator, MappingFault
from aos_middleware.workers.frames import Observed
from aos_middleware.workers.values import kept_texts
from aos_protocol.codec import UNREADABLE
from aos_protocol.documents import AbstractionMapping
from aos_protocol.errors import AosError, SkillError
from aos_protocol.messages import Activate, Fault, Outcome, SkillResult, TopicMessage
from aos_protocol.spelling import did_you_mean, quoted, shortened
from aos_runtime.bus.subscription import merged

_LONGEST_RESPONSE = 1000
"""A longer one is none that a document knows."""

_log = logging.getLogger("aos.middleware")


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
        status = "unknown" if activation.call.was_called else "failed"
    except AosError as error:
        # Of one that is taken up nobody knows whether the middleware before had called the skill.
        is_doubtful = is_taken_up and error.status == "refused"
        fault, status = error, "unknown" if is_doubtful else error.status
    finally:
        told = await around.monitors.end(activation.stop)
    cause = fault or observation.failure
    return Outcome(
        request.id,
        request.skill,
        status,
        shortened(observation.response, _LONGEST_RESPONSE),
        kept_texts(observation.local_variables),
        started_ns=started_ns,
        ended_ns=around.clock.now_ns(),
        fault=None if cause is None else _fault_of(cause),
        assigned=observation.assigned,
        numbers=observation.numbers,
        stopped_by=observation.stopped_by,
        monitors=told.responses | activation.played_monitors,
        monitor_faults=told.faults,
        notices=tuple(activation.notices),
    )


def refused(request: Activate, error: AosError, now_ns: int) -> Outcome:
    """The outcome of an activation that nothing was begun for."""
    return Outcome(
        request.id, request.skill, "refused", started_ns=now_ns, ended_ns=now_ns, fault=_fault_of(error)
    )


def _fault_of(error: AosError) -> Fault:
    return Fault(error.code, error.message, error.hint, error.diagnostics)


class _Activation:
    """The steps of one activation, and what they share: its call, its topics, and what stops it."""

    def __init__(
        self, request: Activate, evaluator: Evaluator, around: Surroundings, is_taken_up: bool
    ) -> None:
        self._request = request
        self._evaluator = evaluator
        self._around = around
        self._mapping: AbstractionMapping = evaluator.emitted.mapping
        self._is_taken_up = is_taken_up
        self.stop = Stop(around.bus, around.keys, request, self._mapping.activation.path)
        self.call = Call(request, self._mapping.activation, around, self.stop)
        self._topics = HeardTopics(request.skill, evaluator, around, self.stop)
        self.played_monitors: dict[str, str] = {}
        self.notices: list[str] = []

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
        numbers = {**result.fields, **result.numbers}
        self._notice(self._around.odd.take(f"the result of {self._request.skill}", numbers))
        self.played_monitors = result.monitors
        if result.response:
            return _Observation(result.response, numbers=numbers_among(result.numbers))
        if self._has_missed and self._topics.keys:
            raise self._missed_topics()
        observed = await self._evaluator.finish(result.fields)
        if observed.response is None:
            raise no_response(self._mapping, result.fields, observed.local_variables)
        return self._observation(observed, observed.response)

    async def _fields(self) -> dict[str, Any]:
        """The fields of the call from the parameters; none where that fails and the adapter needs none."""
        constants = self._evaluator.emitted.constants
        try:
            await self._evaluator.start()
            return await self._evaluator.begin(*self._around.low_level.arguments(self._request, constants))
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
            raise self._missed_topics()
        observed = await self._evaluator.finish({}, "stopped", self.stop.reason)
        if observed.response is None:
            raise self.stop.unexplained(error)
        return replace(self._observation(observed, observed.response), stopped_by=self.stop.by)

    def _observation(self, observed: Observed, response: str) -> _Observation:
        return _Observation(
            response,
            observed.local_variables,
            assigned_variables(observed.assigned, self._request),
            observed_numbers(self._evaluator.emitted.observed, observed.local_variables),
        )

    async def _listening_call(self, fields: dict[str, Any]) -> SkillResult:
        """Calls the skill while topic messages are evaluated.

        Mapping code that fails during the call does not end the call: the skill may be moving.
        """
        result: SkillResult | None = None
        topics = self._topics
        streams = [self._around.bus.listen(key, TopicMessage) for key in topics.keys]
        async with merged(*streams, queue_size=QUEUE_SIZE) as messages, asyncio.TaskGroup() as tasks:
            taking = tasks.create_task(topics.take(messages))
            stopping = tasks.create_task(self.stop.follow())
            try:
                result = await self.call.run(fields)
                await topics.catch_up(result)
            except AosError as error:
                topics.fault = error
            finally:
                stopping.cancel()
                messages.close()
            await topics.finish(taking)
        if messages.dropped:
            self._notice([f"{self._request.skill}: {messages.dropped} topic messages came too fast"])
        if topics.fault is not None:
            raise topics.fault
        assert result is not None
        self._notice(topics.notices(result))
        return result

    def _notice(self, notices: list[str]) -> None:
        for notice in notices:
            _log.warning("%s", notice)
        self.notices += notices

    @property
    def _has_missed(self) -> bool:
        """True where topic messages were sent while nobody listened."""
        return self._is_taken_up or self.call.has_lost_router

    def _missed_topics(self) -> SkillError:
        skill = self._request.skill
        return SkillError(
            f"middleware or router stood still or were started again while {skill} ran: topics were missed",
            code="AOS504",
            hint="The skill has ended; let the robot sense what became of it",
        )


def observed_numbers(names: Iterable[str], local_variables: Mapping[str, str]) -> dict[str, Any]:
    """Returns by name a number, or a list of numbers with None for those that are missing.

    A local variable that is none of these, as text in `local_variables`, was not observed.
    """
    return numbers_among({name: _decoded(local_variables.get(name, "null")) for name in names})


def numbers_among(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns what counts as observed of what a program of the robot's may give as numbers."""
    return {name: value for name, value in values.items() if _is_number(value) or _is_list(value)}


def _decoded(text: str) -> Any:
    """Plain data from JSON; other objects are told by their `repr`, and are no numbers."""
    try:
        return msgspec.json.decode(text)
    except UNREADABLE:
        return None


def _is_number(value: Any) -> bool:
    try:
        return isinstance(value, bool | int | float) and math.isfinite(value)
    except OverflowError:  # No double is so large.
        return False


def _is_list(value: Any) -> bool:
    return isinstance(value, list) and all(item is None or _is_number(item) for item in value)


_FIELD = "response"
"""A derived mapping takes this field from a result."""


def no_response(
    mapping: AbstractionMapping, result: Mapping[str, Any], local_variables: dict[str, str]
) -> MappingFault:
    """No rule holds, or the variable whose text is the response has no value; `result` are its fields."""
    span = mapping.rules[0].span if mapping.rules else mapping.span
    if mapping.is_derived:
        message, hint = _of_derived(mapping, result)
    elif mapping.response_variable:
        message = f"the response is the text of {mapping.response_variable}, which has no value"
        hint = "See that its code assigns it, whatever the skill's result is"
    else:
        values = ", ".join(f"{name}={shortened(text, 200)}" for name, text in local_variables.items())
        message = f"no response rule of {mapping.name} holds ({values or 'no local variables'})"
        hint = "End the rules with one whose condition is True"
    return MappingFault(message, span, code="AOS402", hint=hint, local_variables=local_variables)


def _of_derived(mapping: AbstractionMapping, result: Mapping[str, Any]) -> tuple[str, str]:
    known = [rule.response for rule in mapping.rules]
    response = result.get(_FIELD)
    if response is None:
        has = f"it has {quoted(result)}" if result else "it is empty"
        has = "it is None" if _FIELD in result else has
        message = f"the result of {mapping.activation.path} has no `{_FIELD}`: {has}"
        one_of = f", one of {quoted(known)}" if known else ""
        hint = f"Have the adapter answer with it{one_of}, or write the abstraction mapping {mapping.name}.am"
        return message, hint
    path, name = mapping.activation.path, mapping.name
    message = (
        f"{path} answered with the response {shortened(repr(response), 200)}, which {name} does not know"
    )
    return message, did_you_mean(str(response), known) or f"The skill document knows {quoted(known)}"
