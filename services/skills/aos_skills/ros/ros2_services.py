"""Services of ROS 2 as a transport gives them; actions stand on these and on topics."""

from abc import abstractmethod

from aos_skills.ros.node import RosNode
from aos_skills.ros.types import RosTypes


class Ros2Services(RosNode):
    """The part of a node that differs by transport."""

    def __init__(self, types: RosTypes) -> None:
        super().__init__()
        self.types = types

    @abstractmethod
    async def until_heard(self, topic: str) -> None:
        """Returns when whoever publishes a topic knows of the subscription to it, as far as can be known."""

    @abstractmethod
    async def service_type(self, service: str, type_name: str, timeout_s: float) -> str:
        """The type of a service that some node serves, which is as it is defined here, and the given one.

        The errors are those of `call`.
        """

    @abstractmethod
    def serves(self, service: str) -> bool:
        """Returns whether some node serves it now."""

    @abstractmethod
    def services(self) -> list[str]:
        """The names of all that some node serves now."""

    async def service_gone(self, service: str) -> None:
        """Returns when nobody serves it."""
        while self.serves(service):
            await self.changed()
