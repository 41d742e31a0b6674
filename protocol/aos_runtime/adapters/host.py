"""The host of an adapter: it answers calls and cancellations on the bus, and tells topics and progress.

Here stands what holds for every adapter: one call at a time, at most one motion for each id, a deadline for
each call and for its cancellation, presence of each path that is served.
"""

from __future__ import annotations

import asyncio
import importlib
import logging
import os
import sys
import threading
from collections import Counter, deque
from collections.abc import AsyncIterator, Iterable
from pathlib import Path
from typing import Any

from aos_protocol.errors import AosError, DeployError, SkillError
from aos_protocol.keys import Serving
from aos_protocol.messages import (
    Cancel,
    Cancelled,
    Missions,
    MissionsQuery,
    ProjectQuery,
    ProjectRevision,
    SkillCall,
    SkillProgress,
    SkillResult,
    TopicMessage,
)
from aos_protocol.spelling import did_you_mean
from aos_runtime.adapters.adapter import Adapter, Answer, Call, Observed
from aos_runtime.adapters.blocking import ends_if_blocked
from aos_runtime.adapters.expressions import translated
from aos_runtime.adapters.ledger import Ledger
from aos_runtime.adapters.pauses import Pauses
from aos_runtime.adapters.sendable import sendable
from aos_runtime.adapters.settings import AdapterSettings, Binding
from aos_runtime.asking import ask_until_answered
from aos_runtime.fence import Fence, epoch_of_solver, is_given_up
from aos_runtime.lifecycle import Service
from aos_runtime.older_python import timeout
from aos_runtime.subscription import Subscription

__all__ = ["Host", "load_adapter", "serve_adapter"]

PROGRESS_EVERY_S = 0.05
"""Progress is told this often; of what comes faster, the newest."""

MAX_UNSENT_MESSAGES = 10_000
"""The oldest topic messages give way where more than these wait to be sent."""

MIDDLEWARE_AWAY_S = 2.0
"""A motion is stopped when nobody could hear of it for this long."""

_ASK_TIMEOUT_S = 5.0
_LAST_WORDS_S = 2.0
"""A process has this time for saying why it ends, when something in it cannot be ended."""

_log = logging.getLogger("aos.adapter")


async def serve_adapter(service: Service[AdapterSettings]) -> None:
    """Carries the adapter of the settings until stopped; then it stops what moves."""
    host = Host(service)
    try:
        await host.run()
    except Exception:
        try:
            await host.close()
        except Exception:  # What ended `run` is the reason, and may be the reason of this, too.
            _log.exception("the adapter did not close")
        raise
    except BaseException:
        await host.close()
        raise


def load_adapter(name: str, host: Host) -> Adapter:
    """An adapter by `module:Class`; DeployError AOS802 if there is no such class."""
    module, _, attribute = name.partition(":")
    try:
        adapter: Adapter = getattr(importlib.import_module(module), attribute)(host)
    except (ImportError, AttributeError) as error:
        raise DeployError(
            f"the adapter {name} cannot be loaded: {error}",
            code="AOS802",
            hint="It is named module:Class; see that the module can be imported here",
        ) from error
    return adapter


class _Running:
    """The call that runs."""

    def __init__(self, call: Call, task: asyncio.Task[Answer]) -> None:
        self.call = call
        self.task = task
        self.ended = asyncio.Event()
        self.reason = ""
        self.progress = 0.0
        self.reported_s = float("-inf")


class Host:
    """The surroundings of an adapter. `options` are its own, from the deploy file in `folder`."""

    def __init__(self, service: Service[AdapterSettings]) -> None:
        settings = service.settings
        self.name = settings.service
        self.options = settings.options
        self.folder = Path(settings.folder)
        self.run_dir = Path(settings.run_dir)
        self.seed = settings.seed
        self._service = service
        self._settings = settings
        self._loop = asyncio.get_running_loop()
        self._ledger = Ledger(self.run_dir / f"adapter-{self.name}.db")
        self._fence = Fence(epoch_of_solver(service.bus, service.keys))
        for call in self._ledger.calls():
            self._fence.note(call)
        self._pauses = Pauses()
        self._has_solver = False
        self._published: Counter[str] = Counter()
        self._unsent: deque[tuple[str, dict[str, Any]]] = deque(maxlen=MAX_UNSENT_MESSAGES)
        self._sending = threading.Lock()
        self._is_sending = False
        self._lost = 0
        self._serving: dict[str, str] = {}
        self._answered: set[str] = set()
        self._running: _Running | None = None
        self._failed: asyncio.Future[None] = self._loop.create_future()
        self._adapter: Adapter | None = None

    # --- for adapters --------------------------------------------------------------------------------

    @property
    def bound(self) -> dict[str, Binding]:
        """The paths that the deploy file binds to this adapter."""
        return self._settings.bind

    def chosen(self, known: Iterable[str]) -> list[str]:
        """The paths to serve for an adapter that knows its targets: those that are bound, and for `"*"` the
        others that it has. DeployError AOS801 if a path is bound to a target that it does not know.
        """
        targets = {path.strip("/"): path for path in known}
        for path, binding in self.bound.items():
            target = str(binding.target if binding.target is not None else path)
            if target.strip("/") not in targets:
                has = f"It has {', '.join(sorted(targets.values())) or 'none'}"
                raise DeployError(
                    f"the adapter {self.name} has no skill at {target}",
                    hint=f"{did_you_mean(target, targets.values())} {has}".strip(),
                )
        return [*self.bound, *(path for path in targets.values() if self.wants(path))]

    def wants(self, path: str) -> bool:
        """Returns whether a path that is not bound by name falls to this adapter, by `"*"`."""
        named = {bound.strip("/") for bound in (*self.bound, *self._settings.elsewhere)}
        return self._settings.serves_others and path.strip("/") not in named

    async def serve(self, *paths: str) -> None:
        """Answers calls of these paths from now on, and makes that known. May be called at any time."""
        bus, keys = self._service.bus, self._service.keys
        for path in paths:
            if path not in self._answered:
                self._answered.add(path)
                await bus.answer(keys.call(path), SkillCall, self._call)
                await bus.answer(keys.cancel(path), Cancel, self._cancel)
            if path not in self._serving:
                assert self._adapter is not None
                serving = Serving(self.name, self._adapter.version, bus.instance, path)
                self._serving[path] = keys.serve(serving)
                await bus.announce(self._serving[path])
        _log.info("serves %s", ", ".join(sorted(self._serving)))

    def withdraw(self, *paths: str) -> None:
        """Makes known that these paths cannot be called for now: what stands behind them has gone."""
        for path in paths:
            if path in self._serving:
                self._service.bus.withdraw(self._serving.pop(path))

    def fail(self, error: AosError) -> None:
        """Ends the process with an error: what the adapter needs is not there, and will not come."""
        if not self._failed.done():
            self._failed.set_exception(error)

    def publish(self, topic: str, fields: dict[str, Any]) -> None:
        """Sends a message on a topic. From any thread, in order.

        SkillError AOS510 if a field is nothing that the bus can carry.
        """
        fields = sendable(fields, f"a message on {topic}")
        with self._sending:
            if len(self._unsent) == MAX_UNSENT_MESSAGES:
                self._lost += 1
            self._unsent.append((topic, fields))
            is_first, self._is_sending = not self._is_sending, True
        if is_first:
            self._loop.call_soon_threadsafe(self._send)

    async def revisions(self) -> AsyncIterator[ProjectRevision]:
        """The project's documents as they stand, and each newer revision when it comes."""
        bus, keys, name = self._service.bus, self._service.keys, self._settings.project
        async with bus.listen(keys.announced, ProjectRevision) as announced:
            newest = 0
            try:
                current = await bus.ask(
                    keys.project, ProjectQuery(name), ProjectRevision, timeout_s=_ASK_TIMEOUT_S
                )
            except AosError as error:
                _log.info("no documents yet: %s", error)
            else:
                newest = current.revision
                yield current
            async for _, revision in announced:
                if revision.project.name == name and revision.revision > newest:
                    newest = revision.revision
                    yield revision

    async def missions(self) -> Missions:
        """The missions of the system so far; BusError where the solver stays away."""
        bus, keys = self._service.bus, self._service.keys
        return await ask_until_answered(
            bus,
            keys.missions,
            MissionsQuery(),
            Missions,
            server=keys.live("solver"),
            timeout_s=_ASK_TIMEOUT_S,
        )

    # --- the process ---------------------------------------------------------------------------------

    async def run(self) -> None:
        """Runs until it is stopped, or cannot go on."""
        if self._settings.folder not in sys.path:
            sys.path.append(self._settings.folder)  # For classes that stand beside the deploy file.
        self._adapter = load_adapter(self._settings.adapter, self)
        # Before anything is served: whoever calls may be gone a moment later.
        bus, keys = self._service.bus, self._service.keys
        async with (
            bus.presence(keys.live("middleware")) as middleware,
            bus.presence(keys.live("solver")) as solver,
        ):
            watching = [asyncio.create_task(self._watch_solver(solver))]
            try:
                with self._pauses:
                    await self._adapter.start()
                    await self._service.ready()
                    watching.append(asyncio.create_task(self._watch_middleware(middleware)))
                    await self._failed
            finally:
                for task in watching:
                    task.cancel()

    async def _watch_solver(self, presence: Subscription[tuple[str, bool]]) -> None:
        """Notes that the system has a solver: one that has gone may come again."""
        async for _, is_there in presence:
            self._has_solver = self._has_solver or is_there

    async def _watch_middleware(self, presence: Subscription[tuple[str, bool]]) -> None:
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

    async def close(self) -> None:
        # Whoever stops the process cancels what `run` waits for, which is no failure.
        is_stuck = self._failed.done() and not self._failed.cancelled()
        if not is_stuck:
            if self._running is not None:
                is_stuck = not await self._stop(self._running, "the adapter ends")
            if self._adapter is not None:
                await self._adapter.close()
        if is_stuck:
            # A thread that never ends would keep the process.
            ending = threading.Timer(_LAST_WORDS_S, os._exit, (1,))
            ending.daemon = True
            ending.start()
        self._send()
        self._ledger.close()

    # --- calls ---------------------------------------------------------------------------------------

    async def _call(self, request: SkillCall, _: str) -> SkillResult:
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
            raise SkillError(
                f"{request.path} is refused: {self._running.call.path} is running",
                code="AOS502",
                hint="One skill runs at a time",
            )
        path = "/" + request.path.strip("/")
        if path not in self._serving:
            raise SkillError(f"{self.name} does not serve {path} now", code="AOS505")
        binding = self.bound.get(path, Binding())
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
            on_message=self.publish,
        )
        self._ledger.start(request)
        self._fence.note(request)
        may_take_s = call.deadline_s + self._settings.cancel_s
        running = self._begin(call)
        try:
            with ends_if_blocked(call.path, may_take_s):
                answer = await self._run(running)
            result = self._result(call, binding, answer)
        except AosError as error:
            self._ledger.fail(call.id, error)
            self._tell_end(call, _state_of(error), error.message)
            raise
        else:
            self._ledger.end(result)
        finally:
            running.ended.set()
        self._tell_end(call, "succeeded")
        return result

    async def _check_that_it_is_wanted(self, request: SkillCall) -> None:
        """Refuses a call that would begin now, and may have come while this process stood still.

        Its middleware has perhaps given it up, and the mission holds or does something else.
        """
        if not self._has_solver or not self._pauses.was_there_one:
            return
        is_running = self._running is not None and self._running.call.id == request.id
        if is_running or self._ledger.stored(request.id) is not None:
            return
        if await is_given_up(self._service.bus, self._service.keys, request.id):
            raise SkillError(
                f"the call {request.id} of {request.path} comes too late: {self.name} stood still, and "
                "the mission does not wait for it any more",
                code="AOS506",
                hint="Nothing has moved; call it again if it is still wanted",
            )

    def _begin(self, call: Call) -> _Running:
        assert self._adapter is not None
        running = self._running = _Running(call, asyncio.ensure_future(self._adapter.call(call)))
        self._tell(running, "accepted")
        return running

    async def _run(self, running: _Running) -> Answer:
        """Runs a call to its end, by itself, by its deadline or by a cancellation."""
        call, task = running.call, running.task
        await asyncio.wait({task}, timeout=call.deadline_s)
        is_late = not task.done()
        if is_late and not await self._stop(running, "its time is over"):
            raise self._stuck(call)
        self._running = None
        self._send()  # Its last messages go before its answer.
        error = None if task.cancelled() else task.exception()
        if error is None and not task.cancelled():
            return task.result()
        if is_late:
            raise SkillError(f"{call.path} took longer than it may, {call.deadline_s:g} s", code="AOS503")
        if error is None:
            raise SkillError(f"{call.path} was cancelled: {running.reason}", code="AOS507")
        if isinstance(error, AosError):
            raise error
        _log.error("%s failed", call.path, exc_info=error)
        raise SkillError(
            f"{call.path} failed: {type(error).__name__}: {error}",
            code="AOS510",
            hint=f"See the log of {self.name}",
        ) from error

    def _result(self, call: Call, binding: Binding, answer: Any) -> SkillResult:
        if isinstance(answer, Observed):
            what = f"the observation of {call.path}"
            response = sendable({"response": answer.response}, what)["response"]
            if not isinstance(response, str):
                raise SkillError(f"{what} is {response!r}, which is no word", code="AOS510")
            numbers = sendable(answer.numbers, what)
            published = dict(self._published)
            return SkillResult(call.id, {}, published, response, numbers, dict(answer.monitors))
        try:
            given = dict(answer)
        except (TypeError, ValueError) as error:
            raise SkillError(
                f"{call.path} answered {answer!r}, which is no mapping of field names to values",
                code="AOS510",
                hint=f"Mend the adapter {self.name}",
            ) from error
        fields = translated(binding.result, given, f"the result of {call.path}")
        fields = sendable(fields, f"the result of {call.path}")
        return SkillResult(call.id, fields, dict(self._published))

    async def _cancel(self, cancel: Cancel, _: str) -> Cancelled:
        running = self._running
        is_meant = running is not None and cancel.id in (None, running.call.id)
        if running is None or not is_meant or self._fence.is_stale(cancel):
            return Cancelled()
        if not await self._stop(running, cancel.reason):
            raise self._stuck(running.call)
        return Cancelled((str(running.call.id),))

    async def _stop(self, running: _Running, reason: str) -> bool:
        """Cancels a call; whether it has ended within the time that it has for that."""
        if not running.task.done():
            _log.info("cancelling %s: %s", running.call.path, reason)
            running.reason = running.reason or reason
            self._tell(running, "cancelling", reason)
            running.call.cancel()
            running.task.cancel()
            await asyncio.wait({running.task}, timeout=self._settings.cancel_s)
        return running.task.done()

    def _stuck(self, call: Call) -> AosError:
        """The process ends, so that a new one can start: what it moved is no longer known."""
        text = f"{call.path} did not stop within {self._settings.cancel_s:g} s of its cancellation"
        if not self._failed.done():
            hint = f"It has to end when it is cancelled; see the log of {self.name}"
            self._failed.set_exception(SkillError(text, code="AOS504", hint=hint))
        return SkillError(text, code="AOS504", hint=f"The adapter {self.name} is ended")

    # --- what is told --------------------------------------------------------------------------------

    def _on_progress(self, progress: float, text: str) -> None:
        # Made plain here, so that what is wrong with them is told to whoever gave them.
        self._loop.call_soon_threadsafe(self._take_progress, float(progress), str(text))

    def _take_progress(self, progress: float, text: str) -> None:
        running = self._running
        if running is None or self._loop.time() < running.reported_s + PROGRESS_EVERY_S:
            return
        running.reported_s = self._loop.time()
        running.progress = min(max(progress, 0.0), 1.0)
        self._tell(running, "executing", text)

    def _tell(self, running: _Running, state: str, text: str = "") -> None:
        call = running.call
        progress = SkillProgress(call.id, call.path, state, running.progress, text)
        self._service.bus.tell(self._service.keys.progress(call.path), progress)

    def _tell_end(self, call: Call, state: str, text: str = "") -> None:
        progress = SkillProgress(call.id, call.path, state, 1.0 if state == "succeeded" else 0.0, text)
        self._service.bus.tell(self._service.keys.progress(call.path), progress)

    def _send(self) -> None:
        """Sends what waits, numbered for each topic; what comes meanwhile goes with the next turn."""
        with self._sending:
            waiting, self._is_sending = list(self._unsent), False
            self._unsent.clear()
        for topic, fields in waiting:
            self._published[topic] += 1
            message = TopicMessage(self._published[topic], fields)
            self._service.bus.tell(self._service.keys.topic(topic), message)
        if self._lost:
            _log.warning("%d topic messages came too fast to be sent", self._lost)
            self._lost = 0


def _state_of(error: AosError) -> str:
    """The last state of a call that ended with an error."""
    return error.status if error.status in ("timed_out", "cancelled") else "failed"
