"""Programs that are off the bus though they run: SIGSTOP has stopped them, or the router carries nothing.

Tokens of adapters that are started again, or may be, are waited for by whoever decides.
"""

import asyncio
from collections.abc import Callable, Coroutine, Mapping, Set
from contextlib import suppress
from typing import Any

from aos_deploy.processes.consequence import RunningProgram
from aos_deploy.processes.program import Program
from aos_protocol.errors import BusError
from aos_protocol.keys import Keys
from aos_runtime.bus.bus import Bus
from aos_runtime.clock import Clock

FROZEN_S = 5.0
"""A process of ours that is off the bus for so long, after it was ready, is killed."""

_SILENT = "it runs, and has served nothing for {:g} s; kill {} ends it, and it is started again"


class Silences:
    """Looks after programs that have left the bus.

    `running` are the programs by name, `router` the name of the one that carries what others say, and
    `serving` the paths that are served now. `is_routed` says whether the router is heard, `beside` begins a
    task that ends with the system, and `changed` tells of a program's state.
    """

    def __init__(
        self,
        running: Mapping[str, RunningProgram],
        router: str,
        serving: Set[str],
        clock: Clock,
        *,
        is_routed: Callable[[], bool],
        beside: Callable[[Coroutine[Any, Any, None]], asyncio.Task[None]],
        changed: Callable[[str, str, str], None],
    ) -> None:
        self._running = running
        self._router = router
        self._serving = serving
        self._clock = clock
        self._is_routed = is_routed
        self._beside = beside
        self._changed = changed

    def begin(self, running: RunningProgram, *, serves_less: bool) -> None:
        """Looks for what a silence means: the program ends, or it is frozen, and is killed.

        A program that only `serves_less` is killed by SIGSTOP alone.
        """
        running.silent_since_s = self._clock.monotonic_s()
        look = self._kill_if_stopped if serves_less else self._kill_if_frozen
        running.silence = self._beside(look(running))

    def tell_frozen(self, running: RunningProgram) -> None:
        """Tells that a program is killed since it is frozen."""
        silent_s = self._clock.monotonic_s() - running.silent_since_s
        self._changed(running.program.name, "frozen", f"off the bus for {silent_s:.1f} s; it is killed")

    async def _kill_if_stopped(self, running: RunningProgram) -> None:
        """Kills a user's own program that SIGSTOP has stopped, and tells of one that serves nothing."""
        child = running.child
        await asyncio.sleep(FROZEN_S)
        if not running.program.host and not child.is_frozen() and not self._is_routed():
            await self._until_routed(running)  # The router is silent: the program may be well.
        running.silence = None
        if running.child is child and running.program.host:
            child.stdin.write(b"look\n")  # Its end says what was seen there.
        elif running.child is child and child.is_frozen():
            self._kill_frozen(running)
        elif running.child is child and child.returncode is None:
            name, paths = running.program.name, running.program.paths
            if paths and self._serving.isdisjoint(paths):
                self._changed(name, "silent", _SILENT.format(FROZEN_S, child.pid))

    async def _kill_if_frozen(self, running: RunningProgram) -> None:
        child = running.child
        await self._until_routed(running)
        running.silence = None
        if running.child is child and self._running[self._router].is_ready:
            self._kill_frozen(running)

    async def _until_routed(self, silent: RunningProgram) -> None:
        """Waits for as long as a process may be silent, and for a router that carries what is said.

        One that carries nothing is killed: we are not heard either, and those behind it may be well.
        """
        router = self._running[self._router]
        is_routed = False
        while not is_routed:
            await asyncio.sleep(FROZEN_S)
            # Without a router nobody is heard, and with a new one not at once.
            if self._clock.monotonic_s() - router.started_s < 2 * FROZEN_S:
                await asyncio.sleep(FROZEN_S)
            is_routed = self._is_routed()
            if not is_routed and router.is_ready:
                router.silent_since_s = silent.silent_since_s
                self._kill_frozen(router)

    def _kill_frozen(self, running: RunningProgram) -> None:
        if running.child.returncode is None:
            running.is_ready = False
            self.tell_frozen(running)
            running.end_at_once()


class Returns:
    """The adapters that are expected back on a bus. `beside` begins a task that ends with the system."""

    def __init__(
        self, bus: Bus, keys: Keys, beside: Callable[[Coroutine[Any, Any, None]], asyncio.Task[None]]
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._beside = beside
        self._tokens: dict[str, asyncio.Task[None]] = {}

    def expect(self, program: Program) -> None:
        """Has it known that an adapter is expected back, for as long as its start may take."""
        self.settle(program.name)
        if program.is_adapter:
            key = self._keys.returning(program.name)
            self._tokens[program.name] = self._beside(self._announce(key, program.start_s))

    def settle(self, name: str) -> None:
        """Withdraws what was said of a program: it is ready, or does not come back."""
        if token := self._tokens.pop(name, None):
            token.cancel()
            self._bus.withdraw(self._keys.returning(name))

    async def _announce(self, key: str, within_s: float) -> None:
        with suppress(BusError):  # Without a router nobody decides.
            await self._bus.announce(key)
        await asyncio.sleep(within_s)
        self._bus.withdraw(key)
