"""Starting a process, and waiting until it is present on the bus."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from processes import HANG_S

from aos_runtime.bus import Bus

__all__ = ["until_present"]


@asynccontextmanager
async def until_present(bus: Bus, key: str) -> AsyncIterator[None]:
    """Start the process in its block: the block ends when `key` has come.

    A process that was killed may be present for a moment longer: it goes first.
    """
    async with asyncio.timeout(HANG_S):
        while await _is_there(bus, key):
            pass
        async with bus.presence(key) as present:
            yield
            assert await anext(present) == (key, True)


async def _is_there(bus: Bus, key: str) -> bool:
    # A watch that begins while the key goes may never hear of that.
    async with bus.presence(key) as present:
        return present.has_items
