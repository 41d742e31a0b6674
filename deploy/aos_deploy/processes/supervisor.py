"""Starts the services of a system, notices when one ends, and stops them all.

Our own processes start at once, because a Python interpreter takes longer to start than a service to get
ready; each waits for the bus by itself. Commands of the user's own start when the router listens, so that
they need not wait for it. Readiness is then awaited in the order of the programs: the liveliness token of a
service, the first path that a command serves. They are stopped in the reverse order, the router last.

A service that ends before it is told to ends the supervision with the fault it left, unless its program says
that it may be started again. One that is frozen, which a program of the user's own may be by SIGSTOP alone,
is killed (`silences.py`). `_watch` is the only place that sees a service end.
"""

from __future__ import annotations

import asyncio
import signal
from collections.abc import AsyncIterator, Awaitable, Coroutine
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from msgspec.structs import replace

from aos_deploy.events import Report, ServiceChanged
from aos_deploy.processes.consequence import (
    STARTED_AGAIN,
    THE_RUN_ENDS,
    RunningProgram,
    consequence,
    fatal_end,
    look_at_log,
    status_text,
    told_end,
)
from aos_deploy.processes.passes import Outsider, Passes
from aos_deploy.processes.program import Program
from aos_deploy.processes.ready import Before, before_start, check_port_is_free, until_seen_ready
from aos_deploy.processes.remote import is_lost, was_frozen
from aos_deploy.processes.silences import Returns, Silences
from aos_deploy.processes.start import ROUTER_MODULE, keep_logs_short, shorten_all, start_process
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import ProcessEnd
from aos_protocol.access import OPERATOR, Party
from aos_protocol.errors import DeployError
from aos_protocol.keys import Keys, Serving
from aos_protocol.messages import Cancel, Cancelled
from aos_runtime.bus.bus import Access, Bus
from aos_runtime.bus.subscription import merged
from aos_runtime.clock import Clock
from aos_runtime.failpoints import reach
from aos_runtime.processes.children import MOST_DEADLINES
from aos_runtime.processes.settings import ROUTER_S, ServiceSettings

ROUTER = Program(name="router", module=ROUTER_MODULE, start_s=ROUTER_S, is_restarted=True)

T = TypeVar("T")

_CANCEL_TIMEOUT_S = 2.5
_TOLD_S = 1.0
"""An end that takes longer is told with what is waited for."""
_HOST_S = 2.0
"""A program on another host may take this much longer to end than one here."""


@asynccontextmanager
async def supervised(
    programs: tuple[Program, ...],
    base: ServiceSettings,
    run: RunDirectory,
    report: Report,
    clock: Clock,
    *,
    outsiders: tuple[Outsider, ...] = (),
    ros2: str = "",
) -> AsyncIterator[Supervisor]:
    """A supervisor whose processes are gone when the block ends, however it ends.

    When a service ends by itself the block is cancelled, and an exception group with the reason comes out of
    it. `base` says robot, endpoint and run directory; its service name is not used. The `outsiders` may be
    on the bus, too. At `ros2`, if it is given, nodes of ROS 2 meet.
    """
    parties = [party for program in programs if (party := program.party) is not None]
    passes = Passes(run, parties, outsiders)
    router = {
        "dictionary": str(passes.dictionary),
        "parties": msgspec.to_builtins(passes.parties),
        "ros2": ros2,
    }
    programs = (replace(ROUTER, settings=router), *programs)
    async with asyncio.TaskGroup() as tasks:
        supervisor = Supervisor(programs, base, run, report, clock, tasks, passes)
        try:
            yield supervisor
        finally:
            await supervisor.stop()


class Supervisor:
    """The processes of one system. `bus` is there after `start`. `ends` are those by themselves."""

    bus: Bus

    def __init__(
        self,
        programs: tuple[Program, ...],
        base: ServiceSettings,
        run: RunDirectory,
        report: Report,
        clock: Clock,
        tasks: asyncio.TaskGroup,
        passes: Passes,
    ) -> None:
        self.keys = Keys(base.robot)
        self._router, *self._programs = programs
        self._passes = passes
        self._base = replace(base, router_s=MOST_DEADLINES * ROUTER.start_s)
        self._run = run
        self._report = report
        self._clock = clock
        self._tasks = tasks
        self._started_s = self._routed_s = clock.monotonic_s()
        self._running: dict[str, RunningProgram] = {}
        self._watches: list[asyncio.Task[None]] = []
        self._is_stopping = False
        self._bus: Bus | None = None
        self._returns: Returns | None = None
        self._serving: set[str] = set()
        self._silences = Silences(
            self._running,
            ROUTER.name,
            self._serving,
            clock,
            is_routed=lambda: self.bus.is_routed,
            beside=self._beside,
            changed=self._changed,
        )
        self._besides: list[asyncio.Task[None]] = []
        self._have_started = asyncio.Event()
        self.ends: list[ProcessEnd] = []

    @property
    def pids(self) -> dict[str, int]:
        """Process ids by service."""
        return {name: running.child.pid for name, running in self._running.items()}

    @property
    def is_changing(self) -> bool:
        """True while a program starts, also again, or is silent and may be frozen: each is told."""
        gone = {end.name for end in self.ends if end.then != STARTED_AGAIN}
        staying = (running for name, running in self._running.items() if name not in gone)
        return any(not running.is_ready or running.silence is not None for running in staying)

    # --- starting ---

    async def start(self) -> None:
        """Starts our services and connects to the bus, and begins to start the others; does not wait until
        they are ready.

        DeployError AOS802 if a process cannot be started. Nobody else may listen at the endpoint.
        """
        self._beside(keep_logs_short(self._run.path / "logs"))
        later = [program for program in self._programs if program.command]
        if any(program.is_own for program in later):
            later = [program for program in self._programs if program.command or program.is_adapter]
        for program in (self._router, *self._programs):
            if program not in later:
                await self._spawn(program)
        self._beside(self._start_in_order(later))
        opened = Bus.open(
            self._base.endpoint,
            sender="aos-up",
            connect_timeout_s=self._base.router_s,
            credential=self._passes.credential(OPERATOR),
            access=Access(self._base.robot, Party(name=OPERATOR, role=OPERATOR)),
        )
        self.bus = self._bus = await self._started_in_time(self._running[ROUTER.name], opened)
        self._routed_s = self._clock.monotonic_s()
        self._returns = Returns(self.bus, self.keys, self._beside)
        self._set_ready(self._running[ROUTER.name])
        self._beside(self._follow_presence(self.bus))

    async def _start_in_order(self, programs: list[Program]) -> None:
        """Each program of the user's own when those before it are ready, then the adapters.

        Any of them may connect to the bus at once.
        """
        await self._running[ROUTER.name].ready.wait()
        for program in sorted(programs, key=lambda program: not program.is_own):
            if program.is_own:
                await check_port_is_free(program.name, program.ready)
            await self._spawn(program)
            if program.is_own:
                await self._running[program.name].ready.wait()
        self._have_started.set()

    def _beside(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """A task that ends at the latest when the system is stopped."""
        task = self._tasks.create_task(work)
        self._besides.append(task)
        return task

    async def until_ready(self, *names: str) -> None:
        """Returns when these services are ready, or all if none is named.

        Commands are not awaited here: which of their paths are needed, the documents say. DeployError AOS802
        if a service takes longer than it may, counted from its start.
        """
        for program in self._programs:
            if program.command or (names and program.name not in names):
                continue
            if program.name not in self._running:
                await self._have_started.wait()
            running = self._running[program.name]
            await self._started_in_time(running, running.ready.wait())

    async def _started_in_time(self, running: RunningProgram, awaited: Awaitable[T]) -> T:
        """Returns what comes when it has started; DeployError AOS802 if that takes longer than it may.

        The time counts from its start, and from when there is a router to be heard through. Times in which
        others have the processors do not count.
        """
        program = running.program
        spent_s = self._clock.monotonic_s() - max(running.started_s, self._routed_s)
        try:
            return await running.child.in_time(awaited, program.start_s, spent_s=spent_s)
        except TimeoutError:
            message = f"{program.name} was not ready within {program.start_s:g} s"
            raise DeployError(message, code="AOS802", hint=self.look_at_log(program.name)) from None

    async def until_one_ended(self, *, timeout_s: float) -> None:
        """Returns after the timeout if every process goes on; if one ends, so does the supervision."""
        await asyncio.wait(self._watches, timeout=timeout_s, return_when=asyncio.FIRST_COMPLETED)

    async def _spawn(self, program: Program) -> None:
        running = RunningProgram(program)
        await self._launch(running)
        self._changed(program.name, "starting")
        self._watches.append(self._tasks.create_task(self._watch(running)))

    async def _launch(self, running: RunningProgram) -> None:
        program = running.program
        running.started_s = self._clock.monotonic_s()
        running.restarts.start(running.started_s)
        before = before_start(program.ready, self._run.log(program.name), _folder_of(program))
        if program.name == ROUTER.name:
            self._passes.write_dictionary()  # The router before it, if there was one, has removed its own.
        running.child = await start_process(program, self._base, self._run, self._passes)
        # Not before: another host may be asked first, and what has no process cannot be stopped or counted.
        self._running[program.name] = running
        reach("up.start.after")
        if program.on_exit:
            running.seeking = self._beside(self._seek_ready(running, before))

    async def _seek_ready(self, running: RunningProgram, before: Before) -> None:
        """Looks whether a program of the user's own is ready; DeployError AOS802 if it takes too long."""
        program, ready = running.program, running.program.ready
        try:
            async with asyncio.timeout(program.start_s):
                if ready is not None and ready.exit is not None:
                    await running.ready.wait()  # Its end is seen by `_watch`.
                    return
                if ready is not None:
                    log = self._run.log(program.name)
                    await until_seen_ready(ready, log, before, _folder_of(program))
        except TimeoutError:
            message = f"{program.name} was not ready within {program.start_s:g} s: {ready}"
            hint = f"See `ready` and `start_s` in the deploy file. {self.look_at_log(program.name)}"
            raise DeployError(message, code="AOS802", hint=hint) from None
        self._set_ready(running)

    async def _follow_presence(self, bus: Bus) -> None:
        keys, router = self.keys, self._running[ROUTER.name]
        async with merged(bus.presence(keys.all_live), bus.presence(keys.all_serve)) as changes:
            async for key, is_alive in changes:
                if is_alive and not router.is_ready:
                    self._set_ready(router)  # It was started again, and others are heard through it.
                serving = keys.serving_of(key)
                if serving is not None:
                    (self._serving.add if is_alive else self._serving.discard)(serving.path)
                    running = self._command_behind(serving)
                else:
                    running = self._running.get(keys.service_of(key))
                if running is not None and is_alive and not running.is_ready:
                    self._set_ready(running)
                elif running is not None and not is_alive:
                    self._note_silence(running, serves_less=serving is not None)

    def _command_behind(self, serving: Serving) -> RunningProgram | None:
        """The command that serves a path, by its name in the token or by what is bound to it."""
        for running in self._running.values():
            program = running.program
            is_meant = program.name == serving.adapter or serving.path in program.paths
            if is_meant and program.command and program.is_adapter:
                return running
        return None

    def _note_silence(self, running: RunningProgram, *, serves_less: bool) -> None:
        """A service has left the bus, or a program of the user's own a path: it ends, or it is frozen."""
        running.is_ready = running.is_ready and serves_less
        if running.program.is_restarted and running.silence is None:
            self._silences.begin(running, serves_less=serves_less)
            if not serves_less:
                self._tell_return(running.program, it_comes=True)

    def _tell_return(self, program: Program, *, it_comes: bool) -> None:
        if self._returns is not None:  # Before there is a bus nobody decides.
            self._returns.expect(program) if it_comes else self._returns.settle(program.name)

    def _set_ready(self, running: RunningProgram, state: str = "ready") -> None:
        if running.silence is not None:
            running.silence.cancel()
            running.silence = None
        running.is_ready = True
        self._tell_return(running.program, it_comes=False)
        running.restarts.succeed()
        running.ready.set()
        self._changed(running.program.name, state)

    async def _watch(self, running: RunningProgram) -> None:
        """Raises when the process ends though nobody stopped it, and neither starts again nor is given up."""
        program = running.program
        while True:
            status = await running.child.wait()
            if self._is_stopping:
                return
            if was_frozen(program, status):
                self._silences.tell_frozen(running)
                status = -signal.SIGKILL
            if running.seeking is not None:
                running.seeking.cancel()
            if program.ready is not None and program.ready.exit == status:
                self._set_ready(running, "done")
                return
            running.is_ready = False
            others = [other for other in self._running.values() if other is not running]
            then = consequence(running, status, others, self._run, self._clock.monotonic_s())
            is_told = then == THE_RUN_ENDS
            how = status_text(status) if is_told else told_end(program, self._run, status)
            self._changed(program.name, "ended", f"{how}; {then}")
            after_s = round(self._clock.monotonic_s() - self._started_s, 3)
            self.ends.append(ProcessEnd(program.name, after_s, status_text(status), then))
            self._tell_return(program, it_comes=then == STARTED_AGAIN)
            if then == THE_RUN_ENDS:
                raise fatal_end(running, status, self._run)
            if then != STARTED_AGAIN:
                return
            is_cut = is_lost(program, status)
            await asyncio.sleep(running.restarts.delay_s(self._clock.monotonic_s(), is_cut=is_cut))
            if self._is_stopping:
                return
            self._run.forget_fault(program.name)
            await self._launch(running)
            self._changed(program.name, "starting", f"start {running.restarts.count}")

    def look_at_log(self, name: str) -> str:
        """Returns the place of a service's log, and its last lines."""
        return look_at_log(self._run, name)

    # --- stopping ---

    async def stop(self) -> None:
        """Stops the solver, then whatever the robot still does, then the rest in reverse order."""
        self._is_stopping = True
        for task in self._besides:
            task.cancel()
        await asyncio.gather(*self._besides, return_exceptions=True)
        await self._stop_one("solver")
        await self._cancel_skills()
        for program in reversed(self._programs):
            await self._stop_one(program.name)
        if self._bus is not None:
            await self._bus.close()
        await self._stop_one(ROUTER.name)
        await asyncio.to_thread(shorten_all, self._run.path / "logs")

    def kill(self) -> None:
        """Ends every process at once; what they have started ends with them."""
        self._is_stopping = True
        for running in self._running.values():
            running.end_at_once()

    async def _stop_one(self, name: str) -> None:
        running = self._running.get(name)
        if running is not None and running.child.returncode is None:
            self._changed(name, "stopping")
            slow = f"it has not ended yet; {running.program.stop_s:g} s after it was asked to, it is killed"
            told = asyncio.get_running_loop().call_later(_TOLD_S, self._changed, name, "stopping", slow)
            try:
                if running.program.host:
                    running.child.stdin.close()
                    await running.child.wait_for(running.program.stop_s + _HOST_S)
                await running.child.stop(running.program.ending_s)
            finally:
                told.cancel()
            self._changed(name, "ended")

    async def _cancel_skills(self) -> None:
        """Nobody moves the robot, or whoever does not answer ends in a moment anyway."""
        if self._bus is None:
            return
        questions = [
            self._bus.ask(
                self.keys.cancel(path), Cancel("aos-up stops"), Cancelled, timeout_s=_CANCEL_TIMEOUT_S
            )
            for path in self._serving
        ]
        await asyncio.gather(*questions, return_exceptions=True)

    def _changed(self, service: str, state: str, detail: str = "") -> None:
        after_s = self._clock.monotonic_s() - self._started_s
        self._report(ServiceChanged(service, state, round(after_s, 3), detail))


def _folder_of(program: Program) -> Path:
    """The folder of this machine that paths of a program's `ready` are relative to."""
    return Path() if program.host else Path(program.folder or "")
