"""The adapter `ros2`: a robot whose ROS 2 nodes run rmw_zenoh."""

from __future__ import annotations

from aos_skills.ros.adapter import RosAdapter, interface_places
from aos_skills.ros.node import RosNode
from aos_skills.ros.types import RosTypes
from aos_skills.ros2.node import Node

__all__ = ["Ros2Adapter"]

DEFAULT_ROUTER = "tcp/127.0.0.1:7447"
"""Where `rmw_zenohd` listens by itself."""


class Ros2Adapter(RosAdapter):
    """Options: `router`, `domain`, `distribution`, `interfaces`, `topics`."""

    async def connect(self) -> RosNode:
        options = self.host.options
        types = RosTypes(options.get("distribution", "jazzy"), interface_places(self.host))
        return await Node.open(
            options.get("router", DEFAULT_ROUTER),
            types,
            name=f"aos_{self.host.name}".replace("-", "_"),
            domain=int(options.get("domain", 0)),
        )
