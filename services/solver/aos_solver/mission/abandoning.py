"""Work whose result is not needed any more, given up while it goes on."""

import asyncio
from collections.abc import Coroutine
from contextlib import suppress
from typing import Any, TypeVar

T = TypeVar("T")

GRACE_S = 0.5
"""Work that nobody needs may end within this time: to give a search up costs the engine's process, and with
it the tree that the next search would begin with."""


class Abandoning:
    """Gives the work up that goes on when somebody says so, and all work from some moment on."""

    def __init__(self) -> None:
        self._is_useless = asyncio.Event()
        self._is_over = asyncio.Event()

    def renew(self) -> None:
        """Work that begins from now on is needed, unless all is over."""
        if not self._is_over.is_set():
            self._is_useless.clear()

    def soon(self) -> None:
        """The work that goes on has `GRACE_S` to end."""
        self._is_useless.set()

    def begin(self) -> None:
        """All work is given up from now on, at once."""
        self._is_over.set()
        self._is_useless.set()

    async def unless_given_up(self, work: Coroutine[Any, Any, T]) -> T | None:
        """Returns the result of the work; None where it was given up, which has cancelled it."""
        task = asyncio.ensure_future(work)
        given_up = asyncio.ensure_future(self._until_given_up())
        try:
            await asyncio.wait((task, given_up), return_when=asyncio.FIRST_COMPLETED)
            return task.result() if task.done() else None
        finally:
            task.cancel()
            given_up.cancel()
            await asyncio.gather(task, given_up, return_exceptions=True)

    async def _until_given_up(self) -> None:
        await self._is_useless.wait()
        with suppress(TimeoutError):
            async with asyncio.timeout(GRACE_S):
                await self._is_over.wait()
