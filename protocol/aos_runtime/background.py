"""Work that goes on beside whoever has begun it."""

import asyncio
from collections.abc import Coroutine
from typing import Any


class Background:
    """Tasks that are held until they end; `tasks` are those that have not."""

    def __init__(self) -> None:
        self.tasks: set[asyncio.Task[Any]] = set()

    def begin(self, work: Coroutine[Any, Any, Any]) -> None:
        """Begins work in the loop that runs."""
        task = asyncio.get_running_loop().create_task(work)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    async def cancel(self) -> None:
        """Cancels what goes on, and returns when it has ended."""
        for task in self.tasks:
            task.cancel()
        await asyncio.gather(*self.tasks, return_exceptions=True)
