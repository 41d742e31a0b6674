"""The ROS 2 nodes that are there, and what they serve and publish: the liveliness tokens of one domain."""

import asyncio

from aos_runtime.bus.foreign_bus import ForeignBus
from aos_skills.ros2.wire import Endpoint, Kind, endpoint_of


class Graph:
    """Follows who comes and goes. Names are full, with a leading slash."""

    def __init__(self, bus: ForeignBus, domain: int) -> None:
        self._endpoints: dict[str, Endpoint] = {}
        self._has_changed = asyncio.Event()
        bus.watch(f"@ros2_lv/{domain}/**", self._on_change)

    def _on_change(self, token: str, is_present: bool) -> None:
        endpoint = endpoint_of(token)
        if endpoint is None:
            return
        if is_present:
            self._endpoints[token] = endpoint
        else:
            self._endpoints.pop(token, None)
        self._has_changed.set()

    def find(self, kind: Kind, name: str) -> list[Endpoint]:
        return [one for one in self._endpoints.values() if one.kind is kind and one.name == name]

    def names(self, kind: Kind) -> dict[str, str]:
        """The names of all topics or services with endpoints of a kind, and their types."""
        return {one.name: one.type_name for one in self._endpoints.values() if one.kind is kind}

    async def changed(self) -> None:
        self._has_changed.clear()
        await self._has_changed.wait()

    async def wait_for(self, kind: Kind, name: str, timeout_s: float) -> Endpoint | None:
        """The first endpoint of that kind and name; None if none comes in time."""
        try:
            async with asyncio.timeout(timeout_s):
                while not (found := self.find(kind, name)):
                    await self.changed()
        except TimeoutError:
            return None
        return found[0]
