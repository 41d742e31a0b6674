"""Starts the services of a system, notices when one ends, and stops them all.

Our own processes start at once, because a Python interpreter takes longer to start than a service to get
ready; each waits for the bus by itself. Commands of the user's own start when the router listens, so that
they need not wait for it. Readiness is then awaited in the order of the programs: the liveliness token of a
service, the first path that a command serves. They are stopped in the reverse order, the router last.

A service that ends before it is told to ends the supervision with the fault it left, unless its program says
that it may be started again. `_watch` is the only place that sees a service end.
"""

from __future__ import annotations

import asyncio
import signal
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from aos_deploy.events import Report, ServiceChanged
from aos_deploy.program import Program, settings_of
from aos_deploy.remote import check_ssh, remote_command, why_it_failed
from aos_deploy.run_directory import RunDirectory
from aos_protocol.errors import AosError, DeployError, error_from_code
from aos_protocol.keys import Keys, Serving
from aos_protocol.messages import Cancel, Cancelled
from aos_runtime.bus import Bus
from aos_runtime.children import PIPE, Child, guarded
from aos_runtime.clock import Clock
from aos_runtime.guard import NOT_STARTED
from aos_runtime.lifecycle import ROUTER_S, ServiceSettings
from aos_runtime.subscription import merged

__all__ = ["ROUTER", "Supervisor", "supervised"]

ROUTER = Program(name="router", module="aos_runtime.router", start_s=ROUTER_S)

_CANCEL_TIMEOUT_S = 2.5
_RESTART_S = 0.2
"""Before the first restart of a program; each further one waits twice as long."""


class _Running:
    """A program's process. `starts` counts how often it was started, `ready` is set once it was ready."""

    def __init__(self, program: Program, child: Child) -> None:
        self.program = program
        self.child = child
        self.starts = 1
        self.ready = asyncio.Event()
        self.is_ready = False


@asynccontextmanager
async def supervised(
    programs: tuple[Program, ...],
    base: ServiceSettings,
    run: RunDirectory,
    report: Report,
    clock: Clock,
) -> AsyncIterator[Supervisor]:
    """A supervisor whose processes are gone when the block ends, however it ends.

    When a service ends by itself the block is cancelled, and an exception group with the reason comes out of
    it. `base` says robot, endpoint and run directory; its service name is not used.
    """
    async with asyncio.TaskGroup() as tasks:
        supervisor = Supervisor(programs, base, run, report, clock, tasks)
        try:
            yield supervisor
        finally:
            await supervisor.stop()


class Supervisor:
    """The processes of one system; `bus` is there once `start` has returned."""

    bus: Bus

    def __init__(
        self,
        programs: tuple[Program, ...],
        base: ServiceSettings,
        run: RunDirectory,
        report: Report,
        clock: Clock,
        tasks: asyncio.TaskGroup,
    ) -> None:
        self.keys = Keys(base.robot)
        self._programs = programs
        self._base = base
        self._run = run
        self._report = report
        self._clock = clock
        self._tasks = tasks
        self._started_s = clock.monotonic_s()
        self._running: dict[str, _Running] = {}
        self._watches: list[asyncio.Task[None]] = []
        self._is_stopping = False
        self._bus: Bus | None = None
        self._serving: set[str] = set()
        self._presence: asyncio.Task[None] | None = None

    @property
    def pids(self) -> dict[str, int]:
        """Process ids by service."""
        return {name: running.child.pid for name, running in self._running.items()}

    # --- starting ------------------------------------------------------------------------------------------

    async def start(self) -> None:
        """Starts every process and connects to the bus; does not wait until the services are ready.

        DeployError AOS802 if a process cannot be started. Nobody else may listen at the endpoint.
        """
        for program in (ROUTER, *self._programs):
            if not program.command:
                await self._spawn(program)
        self.bus = self._bus = await Bus.open(
            self._base.endpoint, sender="aos-up", connect_timeout_s=ROUTER.start_s
        )
        self._is_ready(self._running[ROUTER.name])
        self._presence = self._tasks.create_task(self._follow_presence(self.bus))
        for program in self._programs:
            if program.command:
                await self._spawn(program)

    async def until_ready(self, *names: str) -> None:
        """Returns when these services are ready, or all if none is named.

        Commands are not awaited here: which of their paths are needed, the documents say. DeployError AOS802
        if a service takes longer than it may, counted from the start.
        """
        for program in self._programs:
            if program.command or (names and program.name not in names):
                continue
            running = self._running[program.name]
            elapsed_s = self._clock.monotonic_s() - self._started_s
            try:
                async with asyncio.timeout(program.start_s - elapsed_s):
                    await running.ready.wait()
            except TimeoutError:
                raise DeployError(
                    f"{program.name} was not ready within {program.start_s:g} s",
                    code="AOS802",
                    hint=self.look_at_log(program.name),
                ) from None

    async def until_one_ended(self, *, timeout_s: float) -> None:
        """Returns after the timeout if every process goes on; if one ends, so does the supervision."""
        await asyncio.wait(self._watches, timeout=timeout_s, return_when=asyncio.FIRST_COMPLETED)

    async def _spawn(self, program: Program) -> None:
        running = _Running(program, await self._process(program))
        self._running[program.name] = running
        self._changed(program.name, "starting")
        self._watches.append(self._tasks.create_task(self._watch(running)))

    async def _process(self, program: Program) -> Child:
        base = ServiceSettings(
            robot=self._base.robot,
            service=program.name,
            endpoint=self._base.endpoint,
            run_dir=self._base.run_dir,
        )
        settings = self._run.write_settings(program.name, settings_of(program, base))
        told = {
            "AOS_SETTINGS": str(settings),
            "AOS_ENDPOINT": base.endpoint,
            "AOS_ROBOT": base.robot,
            "AOS_ADAPTER": program.name,
        }
        with self._run.log(program.name).open("ab") as log:
            if program.host:
                check_ssh(program.name, program.host)
                command = remote_command(
                    program.command, program.host, program.folder or "", base.endpoint, told, settings
                )
                # Its input stays open: when that ends, so does the program over there.
                return await Child.start(
                    guarded(command), name=program.name, stdin=PIPE, stdout=log, stderr=log
                )
            return await Child.start(
                program.argv(settings),
                name=program.name,
                cwd=program.folder,
                env=told if program.command else None,
                stdout=log,
                stderr=log,
            )

    async def _follow_presence(self, bus: Bus) -> None:
        keys = self.keys
        async with merged(bus.presence(keys.all_live), bus.presence(keys.all_serve)) as changes:
            async for key, is_alive in changes:
                serving = keys.serving_of(key)
                if serving is not None:
                    (self._serving.add if is_alive else self._serving.discard)(serving.path)
                    running = self._command_behind(serving)
                else:
                    running = self._running.get(keys.service_of(key))
                if running is not None and is_alive and not running.is_ready:
                    self._is_ready(running)

    def _command_behind(self, serving: Serving) -> _Running | None:
        """The command that serves a path, by its name in the token or by what is bound to it."""
        commands = (each for each in self._running.values() if each.program.command)
        return next(
            (
                each
                for each in commands
                if each.program.name == serving.adapter or serving.path in each.program.paths
            ),
            None,
        )

    def _is_ready(self, running: _Running) -> None:
        running.is_ready = True
        running.ready.set()
        self._changed(running.program.name, "ready")

    async def _watch(self, running: _Running) -> None:
        """Raises when the process ends though nobody stopped it, and may not be started again."""
        program = running.program
        while True:
            status = await running.child.wait()
            if self._is_stopping:
                return
            running.is_ready = False
            self._changed(program.name, "ended", _status_text(status))
            may_start_again = running.ready.is_set() or (program.command and status != NOT_STARTED)
            if not may_start_again or running.starts > program.restarts:
                if running.ready.is_set() and self._has_other_adapters(running):
                    # What it served is unavailable; the mission goes on with the rest.
                    self._changed(program.name, "given up", self._end_of(running, status).message)
                    return
                raise self._end_of(running, status)
            await asyncio.sleep(_RESTART_S * 2 ** (running.starts - 1))
            if self._is_stopping:
                return
            running.starts += 1
            self._run.forget_fault(program.name)
            running.child = await self._process(program)
            self._changed(program.name, "starting", f"for the {running.starts}. time")

    def _has_other_adapters(self, running: _Running) -> bool:
        others = (each for each in self._running.values() if each is not running)
        return running.program.is_adapter and any(
            each.program.is_adapter and each.child.returncode is None for each in others
        )

    def _end_of(self, running: _Running, status: int) -> AosError:
        name = running.program.name
        fault = self._run.fault(name)
        if fault is not None:
            return error_from_code(
                fault.code,
                f"{name}: {fault.message}",
                hint=fault.hint,
                diagnostics=fault.diagnostics,
            )
        host = running.program.host
        if host and (failed := why_it_failed(name, host, status, self._run.last_log_lines(name))):
            return failed
        code = "AOS804" if running.ready.is_set() else "AOS802"
        return DeployError(
            f"{name} ended unexpectedly: {_status_text(status)}", code=code, hint=self.look_at_log(name)
        )

    def look_at_log(self, name: str) -> str:
        """Where a service's log is, and how it ends."""
        lines = self._run.last_log_lines(name)
        where = f"Its log is {self._run.log(name)}"
        return "\n    ".join([f"{where}; it ends:", *lines]) if lines else where

    # --- stopping ------------------------------------------------------------------------------------------

    async def stop(self) -> None:
        """Stops the solver, then whatever the robot still does, then the rest in reverse order."""
        self._is_stopping = True
        if self._presence is not None:
            self._presence.cancel()
        await self._stop_one("solver")
        await self._cancel_skills()
        for program in reversed(self._programs):
            await self._stop_one(program.name)
        if self._bus is not None:
            await self._bus.close()
        await self._stop_one(ROUTER.name)

    def kill(self) -> None:
        """Ends every process at once; what they have started ends with them."""
        self._is_stopping = True
        for running in self._running.values():
            running.child.kill()

    async def _stop_one(self, name: str) -> None:
        running = self._running.get(name)
        if running is not None and running.child.returncode is None:
            self._changed(name, "stopping")
            if running.program.host:
                running.child.stdin.close()
                await running.child.wait_for(running.program.stop_s)
            await running.child.stop(running.program.stop_s)
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


def _status_text(status: int) -> str:
    if status >= 0:
        return f"exit status {status}"
    return f"killed by {signal.Signals(-status).name}"
