"""Goals that did not end when they were told to: until they do, the robot may still move."""

import asyncio
from collections.abc import Awaitable


class UnendedGoals:
    """Waits in the background for the end of each such goal. Belongs to the event loop that runs."""

    def __init__(self) -> None:
        self._waiting: dict[asyncio.Future[None], str] = {}

    def add(self, action: str, *ends: Awaitable[object]) -> None:
        """Holds a goal of this action as moving until one of these has come, as an answer or as an error."""
        task = asyncio.ensure_future(_first(ends))
        self._waiting[task] = action
        task.add_done_callback(self._waiting.pop)

    @property
    def actions(self) -> list[str]:
        """The names of the actions whose goals may still move the robot."""
        return list(self._waiting.values())

    async def close(self) -> None:
        """Waits no longer."""
        waiting = list(self._waiting)
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)


async def _first(ends: tuple[Awaitable[object], ...]) -> None:
    futures = [asyncio.ensure_future(end) for end in ends]
    try:
        await asyncio.wait(futures, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for future in futures:
            future.cancel()
        await asyncio.gather(*futures, return_exceptions=True)
