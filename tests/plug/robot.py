import asyncio
from typing import Any

MOVES_S = 0.05


async def listen(call: Any) -> dict[str, str]:
    """Hears the tiger after a while."""
    await asyncio.sleep(MOVES_S)
    return {"answer": "left"}


async def wait(call: Any) -> dict[str, str]:
    await asyncio.sleep(MOVES_S)
    return {"answer": "waited"}
