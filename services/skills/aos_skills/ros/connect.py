"""The node of each kind, from the options of a deploy file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from aos_skills.ros.node import RosNode

KINDS = ("ros2", "dds", "ros1")

DEFAULT_ROUTER = "tcp/127.0.0.1:7447"
"""`rmw_zenohd` listens here by itself."""


async def connect(kind: str, name: str, options: Mapping[str, Any], folder: Path) -> RosNode:
    """Joins the robot's system as the node `name`; files of interfaces are looked for from `folder`.

    BusError AOS605 if it cannot be reached, DeployError AOS805 if a package for it is not installed.
    """
    given = options.get("interfaces", [])
    interfaces = [folder / place for place in ([given] if isinstance(given, str) else given)]
    name = name.replace("-", "_")
    # Each kind needs a package of its own, which others do not need.
    if kind == "ros1":
        from aos_skills.ros1.node import DEFAULT_MASTER, DEFAULT_PYTHON, Ros1Node

        return await Ros1Node.open(
            options.get("master") or DEFAULT_MASTER,
            name=name,
            interfaces=interfaces,
            python=options.get("python", DEFAULT_PYTHON),
        )
    from aos_skills.ros.types import RosTypes

    types = RosTypes(options.get("distribution", "jazzy"), interfaces)
    domain = int(options.get("domain", 0))
    if kind == "dds":
        from aos_skills.dds.node import DdsNode

        interface = str(options.get("interface") or "lo")
        return DdsNode(types, domain=domain, interface=interface, peers=tuple(options.get("peers", ())))
    from aos_skills.ros2.node import Node

    return await Node.open(options.get("router") or DEFAULT_ROUTER, types, name=name, domain=domain)
