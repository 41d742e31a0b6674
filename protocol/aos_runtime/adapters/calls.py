"""The calls of an adapter: one at a time, at most one motion for each id, a deadline for each and its end."""

import asyncio
import inspect
import logging
from collections.abc import Callable
from pathlib import Path

from msgspec.structs import replace

from aos_protocol.errors import AosError, SkillError
from aos_protocol.messages import Cancel, Cancelled, SkillCall, SkillProgress, SkillResult
from aos_protocol.spelling import error_text, sendable_text
from aos_runtime.adapters.adapter import Adapter, Answer, Call, MovesOn
from aos_runtime.adapters.expressions import translated
from aos_runtime.adapters.outbox import Outbox
from aos_runtime.adapters.pauses import Pauses
from aos_runtime.adapters.results import ends_if_blocked, result_of
from aos_runtime.adapters.running_call import CallLedger, RunningCall, last_progress
from aos_runtime.adapters.settings import AdapterSettings, Binding
from aos_runtime.bus.subscription import Subscription
from aos_runtime.older_python import timeout
from aos_runtime.parties.fence import Fence, epoch_of_solver, is_waited_for
from aos_runtime.processes.lifecycle import Service, root_cause

MIDDLEWARE_AWAY_S = 2.0
"""A motion is stopped when nobody could hear of it for this long."""

_log = logging.getLogger("aos.adapter")


class Calls:
    """The answers to calls and cancellations.

    What cannot be ended goes to `fail`: the process has to end, so that a new one can start.
    """

    def __init__(
        self,
        service: Service[AdapterSettings],
        outbox: Outbox,
        pauses: Pauses,
        is_served: Callable[[str], bool],
        fail: Callable[[AosError], None],
    ) -> None:
        self._bus = service.bus
        self._keys = service.keys
        self._settings = service.settings
        self._outbox = outbox
        self._pauses = pauses
        self._is_served = is_served
        self._fail = fail
        self._loop = asyncio.get_running_loop()
        name = f"adapter-{service.settings.service}.db"
        self._ledger = CallLedger(Path(service.settings.run_dir) / name)
        self._fence = Fence(epoch_of_solver(service.bus, service.keys))
        for call in self._ledger.requests():
            self._fence.note(call)
        self._has_solver = False
        self._running: RunningCall | None = None
        self._adapter: Adapter

    def go_to(self, adapter: Adapter) -> None:
        """Gives calls to this adapter from now on."""
        self._adapter = adapter

    async def watch_solver(self, presence: Subscription[tuple[str, bool]]) -> None:
        """Notes that the system has a solver: one that has gone may come again."""
        async for _, is_there in presence:
            self._has_solver = self._has_solver or is_there

    async def watch_middleware(self, presence: Subscription[tuple[str, bool]]) -> None:
        """Stops what moves when the middleware, or the bus, was away for too long."""
        is_there = True  # A call by hand needs none.
        while True:
            try:
                async with timeout(None if is_there else MIDDLEWARE_AWAY_S):
                    _, is_there = await anext(presence)
            except TimeoutError:
                is_there = True  # What runs is stopped once.
                running = self._running
                if running is not None and not await self._stop(running, "the middleware has gone"):
                    self._stuck(running.call)

    async def run(self, request: SkillCall, _: str) -> SkillResult:
        """Runs a call, joins the one of the same id, or tells again how it ended."""
        try:
            await self._fence.check(request)
            await self._check_that_it_is_wanted(request)
        except SkillError as error:
            _log.warning("refused: %s", error)
            raise
        running = self._running
        if running is not None and running.call.id == request.id:
            await running.ended.wait()
        stored = self._ledger.stored(request.id)
        if stored is not None:
            return stored
        if self._running is not None:
            hint = "One skill runs at a time"
            raise SkillError(f"{request.path} is refused: {self._running.call.path} is running", hint=hint)
        path = "/" + request.path.strip("/")
        if not self._is_served(path):
            raise SkillError(f"{self._settings.service} does not serve {path} now", code="AOS505")
        binding = self._settings.bind.get(path, Binding())
        fields = translated(binding.fields, request.fields, f"a call of {path}")
        target = binding.target if binding.target is not None else path
        call = Call(
            id=request.id,
            path=path,
            target=target,
            fields=fields,
            deadline_s=request.deadline_s,
            skill=request.skill,
            parameters=request.parameters,
            on_progress=self._on_progress,
            on_message=self._outbox.publish,
        )
        self._ledger.start(request)
        self._fence.note(request)
        may_take_s = call.deadline_s + self._settings.cancel_s
        lost_before = self._outbox.lost
        running = self._begin(call)
        try:
            with ends_if_blocked(call.path, may_take_s):
                answer = await self._ended(running)
            result = result_of(call, binding, answer, self._outbox.sent, self._settings.service)
            if lost := self._outbox.lost - lost_before:
                result = replace(result, lost=dict(lost))
        except AosError as error:
            self._ledger.fail(call.id, error)
            self._tell(last_progress(call, error))
            raise
        else:
            self._ledger.end(result)
        finally:
            running.ended.set()
        self._tell(last_progress(call, None))
        return result

    async def _check_that_it_is_wanted(self, request: SkillCall) -> None:
        """Refuses a call that would begin now, and may have come while this process stood still.

        Its middleware has perhaps given it up, and the mission holds or does something else. A robot that
        moves while nobody looks is worse than one that is asked twice.
        """
        if not self._has_solver or not self._pauses.was_there_one:
            return
        is_running = self._running is not None and self._running.call.id == request.id
        if is_running or self._ledger.stored(request.id) is not None:
            return
        is_wanted = await is_waited_for(self._bus, self._keys, request.id)
        if is_wanted:
            return
        reason = (
            "nobody tells whether the mission waits" if is_wanted is None else "the mission does not wait"
        )
        raise SkillError(
            f"the call {request.id} of {request.path} may be outdated: {self._settings.service} stood still, "
            f"and {reason} for it",
            code="AOS506",
            hint="Nothing has moved; call it again if it is still wanted",
        )

    def _begin(self, call: Call) -> RunningCall:
        task = asyncio.create_task(self._answer_of(self._adapter, call))
        running = self._running = RunningCall(call, task, self._tell)
        running.tell("accepted")
        return running

    async def _answer_of(self, adapter: Adapter, call: Call) -> Answer:
        answer = adapter.call(call)
        if not inspect.isawaitable(answer):
            message = f"{call.path} answered at once, which `call` of an adapter may not"
            hint = f"Write it as `async def call(self, call)` in the adapter {self._settings.service}"
            raise SkillError(message, code="AOS510", hint=hint)
        return await answer

    async def _ended(self, running: RunningCall) -> Answer:
        """Runs a call to its end, by itself, by its deadline or by a cancellation."""
        call, task = running.call, running.task
        given_up = asyncio.create_task(running.stuck.wait())
        await asyncio.wait({task, given_up}, timeout=call.deadline_s, return_when=asyncio.FIRST_COMPLETED)
        given_up.cancel()
        is_late = not task.done()
        if is_late and not running.stuck.is_set():
            await self._stop(running, "its time is over")
        if running.stuck.is_set():
            raise self._stuck(call)
        self._running = None
        self._outbox.send()  # Its last messages go before its answer.
        what_it_awaits = asyncio.CancelledError("what it awaits was cancelled")
        error = what_it_awaits if task.cancelled() else task.exception()
        if error is None:
            return task.result()
        cause = root_cause(error)  # Tasks of a group fail together.
        is_unknown = isinstance(cause, AosError) and cause.code == "AOS504"
        if is_late and not is_unknown:
            raise SkillError(
                f"{call.path} took longer than it may, {round(call.deadline_s, 1):g} s", code="AOS503"
            )
        if task.cancelled() and call.is_cancelled:
            raise SkillError(f"{call.path} was cancelled: {running.reason}", code="AOS507")
        if isinstance(cause, AosError):
            raise cause
        _log.error("%s failed", call.path, exc_info=error)
        message = f"{call.path} failed: {error_text(cause)}"
        raise SkillError(message, code="AOS510", hint=f"See the log of {self._settings.service}") from error

    async def cancel(self, cancel: Cancel, _: str) -> Cancelled:
        """Cancels the call that is meant, if it runs.

        SkillError AOS504 where the robot does not stop, or goes on though the call has ended.
        """
        running = self._running
        is_meant = running is not None and cancel.id in (None, running.call.id)
        stopped: tuple[str, ...] = ()
        if running is not None and is_meant and not self._fence.is_stale(cancel):
            if not await self._stop(running, cancel.reason):
                raise self._stuck(running.call)
            stopped = (str(running.call.id),)
        if cancel.id is not None and isinstance(self._adapter, MovesOn):
            self._check_that_it_stands_still(self._adapter)  # Its call may have ended, and the robot go on.
        return Cancelled(stopped)

    def _check_that_it_stands_still(self, adapter: MovesOn) -> None:
        if moving := adapter.still_moving():
            raise SkillError(f"{moving} has not ended", code="AOS504", hint="Stop it at the robot")

    async def _stop(self, running: RunningCall, reason: str) -> bool:
        """Cancels a call; whether it has ended within the time that it has for that, told to all alike."""
        if not running.task.done():
            if not running.call.is_cancelled:  # A second cancellation would end what stops the robot.
                _log.info("cancelling %s: %s", running.call.path, reason)
                running.reason = reason
                running.tell("cancelling", reason)
                running.call.cancel()
                running.task.cancel()
            await asyncio.wait({running.task}, timeout=self._settings.cancel_s)
            if not running.task.done():
                running.stuck.set()
        return not running.stuck.is_set()

    def _stuck(self, call: Call) -> AosError:
        """The process ends, so that a new one can start: what it moved is no longer known."""
        text = f"{call.path} did not stop within {self._settings.cancel_s:g} s of its cancellation"
        hint = "It has to end when it is cancelled; a class whose robot brakes longer has `still_moving()`"
        self._fail(SkillError(text, code="AOS504", hint=hint))
        return SkillError(text, code="AOS504", hint=f"The adapter {self._settings.service} is ended")

    async def stop_all(self) -> bool:
        """Cancels what runs; False if it goes on all the same."""
        return self._running is None or await self._stop(self._running, "the adapter ends")

    def close(self) -> None:
        self._ledger.close()

    def _tell(self, progress: SkillProgress) -> None:
        self._bus.tell(self._keys.progress(progress.path), progress)

    def _on_progress(self, progress: float, text: str) -> None:
        # Made plain here, so that what is wrong with them is told to whoever gave them.
        self._loop.call_soon_threadsafe(self._take_progress, float(progress), sendable_text(str(text)))

    def _take_progress(self, progress: float, text: str) -> None:
        if self._running is not None:
            self._running.advance(progress, text)
