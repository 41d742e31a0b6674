"""Work that is given up as soon as somebody says so."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

__all__ = ["Abandoning"]

T = TypeVar("T")


class Abandoning:
    """Gives work up once it has begun, which it does once and for all."""

    def __init__(self) -> None:
        self._begun = asyncio.Event()

    def begin(self) -> None:
        """All work is given up from now on."""
        self._begun.set()

    async def unless_begun(self, work: Coroutine[Any, Any, T]) -> T | None:
        """Returns the result of the work; None where it was given up, which has cancelled it."""
        task = asyncio.ensure_future(work)
        begun = asyncio.ensure_future(self._begun.wait())
        try:
            await asyncio.wait((task, begun), return_when=asyncio.FIRST_COMPLETED)
            return task.result() if task.done() else None
        finally:
            task.cancel()
            begun.cancel()
            await asyncio.gather(task, begun, return_exceptions=True)
