"""The adapters' paths that are served now, as their tokens tell."""

from __future__ import annotations

from aos_protocol.keys import Keys, Lack, Serving
from aos_runtime.bus.bus import Bus


async def served(bus: Bus, keys: Keys) -> list[Serving]:
    """Each path with who serves it; one that several serve is there several times."""
    found = []
    async with bus.presence(keys.all_serve) as present:
        while present.has_items:
            key, is_there = await anext(present)
            if is_there and (serving := keys.serving_of(key)) is not None:
                found.append(serving)
    return found


async def lacks(bus: Bus, keys: Keys) -> list[Lack]:
    """Returns why adapters that are there do not serve paths now."""
    found = []
    async with bus.presence(keys.all_lacks) as present:
        while present.has_items:
            key, is_there = await anext(present)
            if is_there and (lack := keys.lack_of(key)) is not None:
                found.append(lack)
    return found
