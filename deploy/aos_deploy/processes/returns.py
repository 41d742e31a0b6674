"""Tokens of adapters that are started again, or may be: who decides waits for them."""

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import suppress
from typing import Any

from aos_deploy.processes.program import Program
from aos_protocol.errors import BusError
from aos_protocol.keys import Keys
from aos_runtime.bus.bus import Bus


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
