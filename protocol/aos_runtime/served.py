"""The paths that adapters serve now, as their tokens tell."""

from __future__ import annotations

from aos_protocol.keys import Keys
from aos_runtime.bus import Bus

__all__ = ["served_paths"]


async def served_paths(bus: Bus, keys: Keys) -> list[str]:
    """The paths by name, each once."""
    paths = set()
    async with bus.presence(keys.all_serve) as present:
        while present.has_items:
            key, is_there = await anext(present)
            if is_there and (serving := keys.serving_of(key)) is not None:
                paths.add(serving.path)
    return sorted(paths)
