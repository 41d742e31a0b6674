"""The adapter `ros1`: a robot that runs ROS 1."""

from __future__ import annotations

from aos_skills.ros.adapter import RosAdapter, interface_places
from aos_skills.ros.node import RosNode
from aos_skills.ros1.node import DEFAULT_MASTER, DEFAULT_PYTHON, Ros1Node

__all__ = ["Ros1Adapter"]


class Ros1Adapter(RosAdapter):
    """Options: `master`, `python`, `interfaces`, `topics`."""

    async def connect(self) -> RosNode:
        options = self.host.options
        return await Ros1Node.open(
            options.get("master", DEFAULT_MASTER),
            name=f"aos_{self.host.name}".replace("-", "_"),
            interfaces=interface_places(self.host),
            python=options.get("python", DEFAULT_PYTHON),
        )
