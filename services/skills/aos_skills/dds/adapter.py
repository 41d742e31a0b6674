"""The adapter `dds`: a robot whose ROS 2 nodes run Cyclone DDS, or Fast DDS for topics."""

from __future__ import annotations

from aos_skills.dds.node import DdsNode
from aos_skills.ros.adapter import RosAdapter, interface_places
from aos_skills.ros.node import RosNode
from aos_skills.ros.types import RosTypes

__all__ = ["DdsAdapter"]


class DdsAdapter(RosAdapter):
    """Options: `interface`, `peers`, `domain`, `distribution`, `interfaces`, `topics`."""

    async def connect(self) -> RosNode:
        options = self.host.options
        return DdsNode(
            RosTypes(options.get("distribution", "jazzy"), interface_places(self.host)),
            domain=int(options.get("domain", 0)),
            interface=str(options.get("interface", "lo")),
            peers=tuple(options.get("peers", ())),
        )
