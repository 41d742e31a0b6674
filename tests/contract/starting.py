import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from processes import HANG_S

from aos_runtime.bus.bus import Bus


@asynccontextmanager
async def until_present(bus: Bus, key: str) -> AsyncIterator[None]:
    """Start the process in its block: the block ends when `key` has come.

    A process that was killed may be present for a moment longer: it goes first.
    """
    async with asyncio.timeout(HANG_S), bus.presence(key) as present:
        if present.has_items:
            assert await anext(present) == (key, True)
            assert await anext(present) == (key, False)
        yield
        assert await anext(present) == (key, True)
