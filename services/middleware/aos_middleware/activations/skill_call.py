"""The call of one activation: when it may go out, how it ends, and what is known where nobody answers.

A call is asked for again where the router has gone, and cancelled where it is late.
"""

import asyncio
import logging
from typing import Any

from aos_middleware.activations.surroundings import Surroundings
from aos_middleware.robot.motion_gate import GONE_S
from aos_middleware.robot.served_paths import no_adapter
from aos_middleware.robot.stopping import Stop
from aos_protocol.codec import TooLargeError
from aos_protocol.documents import Activation
from aos_protocol.errors import AosError, LateAnswerError, LostAnswerError, NobodyAnswersError, SkillError
from aos_protocol.messages import Activate, Cancel, Cancelled, SkillCall, SkillResult, Stray
from aos_runtime.bus.config import LEASE_S
from aos_runtime.clock import Clock
from aos_runtime.failpoints import reach
from aos_runtime.parties.asking import AWAY_S

_LOOK_S = 0.25
_PAUSE_S = 0.7 * LEASE_S - _LOOK_S
"""The router, which hears of this process each quarter of the lease, may take it for dead after this."""


class PauseWatch:
    """Compares the time between two looks at the clock with what it should be."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._looked_at_s = clock.monotonic_s()
        self._has_paused = False

    async def follow(self) -> None:
        """Looks at the clock until it is cancelled."""
        while True:
            await asyncio.sleep(_LOOK_S)
            self._look()

    def stood_still(self) -> bool:
        """Returns whether there was a pause since the last call that the router may have noticed."""
        self._look()  # The caller may run before `follow`, which was to look earlier.
        told, self._has_paused = self._has_paused, False
        return told

    def _look(self) -> None:
        now_s = self._clock.monotonic_s()
        pause_s, self._looked_at_s = now_s - self._looked_at_s - _LOOK_S, now_s
        if pause_s >= _PAUSE_S:
            self._has_paused = True
            _log.warning("the middleware stood still for %.1f s, as if frozen by a signal", pause_s)


_REPLY_GRACE_S = 0.2
_CANCEL_S = 0.25
"""An activation that is late waits so long for word that its skill has stopped; the next one waits on."""
_RETURN_S = 5.0

_log = logging.getLogger("aos.middleware")


class Call:
    """One call of a skill.

    `was_called` says that the skill may have begun, `has_lost_router` that messages may have been lost since.
    """

    def __init__(self, request: Activate, activation: Activation, around: Surroundings, stop: Stop) -> None:
        self.was_called = False
        self.has_lost_router = False
        self._request = request
        self._path = activation.path
        self._max_duration_s = activation.max_duration_s
        self._around = around
        self._bus, self._keys, self._clock = around.bus, around.keys, around.clock
        self._stop = stop

    async def run(self, fields: dict[str, Any]) -> SkillResult:
        """Calls the skill once nothing else moves, and returns its result.

        SkillError where it cannot be called, has failed, is late or was lost.
        """
        path = self._path
        if self._around.served.announced(path):
            # After the router, its clients are back within a moment.
            await self._around.served.is_back(path, GONE_S)
        with self._around.gate.passing(path):
            was_served = bool(self._around.served.servers(path))
            await self._around.gate.confirm()
            # An adapter that cannot stop ends its process, and is started again.
            if was_served and not self._around.served.servers(path):
                await self._around.served.is_back(path, _RETURN_S)
            if fault := self._around.served.fault(path):
                raise fault
            self._stop.let_out()
            return await self._call_path(path, fields)

    async def _call_path(self, path: str, fields: dict[str, Any]) -> SkillResult:
        """The answer to the call; there is doubt whether it has ended unless the adapter says that it has."""
        request = self._request
        self.was_called = True
        started_s = self._clock.monotonic_s()
        limit_s = request.deadline_s
        if self._max_duration_s is not None:
            limit_s = min(limit_s, self._max_duration_s)
        call = SkillCall(request.id, path, fields, limit_s, request.skill, request.parameters, request.epoch)
        has_ended = False
        try:
            result = await self._answer(path, call)
            has_ended = result.id == request.id
        except LateAnswerError as error:
            has_ended = await self._cancel(f"{request.skill} did not end within {limit_s:g} s")
            message = f"the skill at {path} did not answer within {round(limit_s, 1):g} s"
            hint = (
                "See the skill's log. Its time is the mapping's `max_duration`, or `timeout_s` or "
                "`activation_timeout_s` of the deploy file"
            )
            raise SkillError(message, code="AOS503", hint=hint) from error
        except LostAnswerError as error:
            after_s = self._clock.monotonic_s() - started_s
            has_left = await self._around.served.has_left(path, GONE_S)
            raise (_lost_adapter if has_left else _dropped)(path, after_s) from error
        except NobodyAnswersError as error:
            # One that ends at once may have begun before its receipt went out.
            after_s = self._clock.monotonic_s() - started_s
            was_there = await self._around.served.has_left(path, GONE_S)
            raise (_lost_adapter(path, after_s) if was_there else no_adapter(path)) from error
        except SkillError as error:
            has_ended = error.status != "unknown"
            raise
        except TooLargeError as error:
            has_ended = True
            raise SkillError(error.message, hint=error.hint) from error
        finally:
            if not has_ended:
                self._around.gate.doubt(request, path)
        if not has_ended:
            self._note_stray("foreign", result)
            message = f"the adapter of {path} answered for {result.id}, not for {request.id}"
            raise SkillError(message, code="AOS504", hint="Mend the adapter: a result has the id of its call")
        return result

    async def _answer(self, path: str, call: SkillCall) -> SkillResult:
        """Returns the adapter's answer; the call is asked for again where the router has gone, and where this
        process stood still for so long that the router took it for dead."""
        limit_s = call.deadline_s + _REPLY_GRACE_S
        watch = PauseWatch(self._clock)
        watching = asyncio.create_task(watch.follow())
        try:
            while True:
                router = self._bus.router
                reach("middleware.call.before")
                try:
                    result = await self._bus.ask(
                        self._keys.call(path), call, SkillResult, timeout_s=limit_s, on_stray=self._note_stray
                    )
                except (LostAnswerError, NobodyAnswersError):
                    if not await self._bus.has_lost_router(router) and not watch.stood_still():
                        raise
                    self.has_lost_router = True
                    if not await self._around.served.is_back(path, AWAY_S):
                        raise
                    _log.info("%s is asked again, since the link to the router was lost", path)
                else:
                    reach("middleware.call.after")
                    return result
        finally:
            watching.cancel()

    async def _cancel(self, reason: str) -> bool:
        """Has the skill stopped; whether its adapter says that it has."""
        cancel = Cancel(reason, self._request.id, self._request.epoch)
        key = self._keys.cancel(self._path)
        try:
            await self._bus.ask(key, cancel, Cancelled, timeout_s=_CANCEL_S)
        except AosError as error:
            _log.warning("%s, and nobody says that it has stopped: %s", reason, error)
            return False
        return True

    def _note_stray(self, kind: str, reply: SkillResult | AosError) -> None:
        """A reply that is not used is kept for people."""
        path, request = self._path, self._request
        text = str(reply) if isinstance(reply, AosError) else f"a result for {reply.id}"
        _log.warning("%s: a %s reply for %s is not used: %s", path, kind, request.id, text)
        self._around.on_stray(Stray(request.id, path, kind, text))


def _dropped(path: str, after_s: float) -> SkillError:
    message = f"the adapter of {path} dropped the call {after_s:.1f} s after it came, and is still there"
    hint = "Mend the adapter: it replies to each call. Whether the skill did its work is not known"
    return SkillError(message, code="AOS504", hint=hint)


def _lost_adapter(path: str, after_s: float) -> SkillError:
    message = f"the adapter of {path} was lost {after_s:.1f} s after it was called"
    return SkillError(message, code="AOS504", hint="Whether the skill did its work is not known")
