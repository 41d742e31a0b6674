"""The adapters' paths that are served now, and why others are not, as their tokens tell."""

from collections.abc import Callable
from typing import TypeVar

from aos_protocol.keys import Keys, Lack, Serving
from aos_runtime.bus.bus import Bus

T = TypeVar("T")


async def served(bus: Bus, keys: Keys) -> list[Serving]:
    """Each path with who serves it; one that several serve is there several times."""
    return await _told(bus, keys.all_serve, keys.serving_of)


async def lacks(bus: Bus, keys: Keys) -> list[Lack]:
    """Returns why adapters that are there do not serve paths now."""
    return await _told(bus, keys.all_lacks, keys.lack_of)


async def _told(bus: Bus, tokens: str, contents_of: Callable[[str], T | None]) -> list[T]:
    async with bus.presence(tokens) as present:
        found = []
        while present.has_items:
            key, is_there = await anext(present)
            if is_there and (contents := contents_of(key)) is not None:
                found.append(contents)
    return found
