"""The common part of all ROS 2 nodes: actions stand on services and topics, whatever carries these."""

import logging
from abc import abstractmethod
from collections.abc import Callable

from aos_protocol.errors import AosError
from aos_skills.ros.action_client import ActionClient
from aos_skills.ros.action_server import ActionServer
from aos_skills.ros.node import ActionEnd, ActionRequest, Fields, RosNode, RunGoal, named_skills
from aos_skills.ros.types import RosTypes

_log = logging.getLogger("aos.ros2")


class Ros2Node(RosNode):
    """A node over a transport that gives topics, services and who is there."""

    def __init__(self, types: RosTypes) -> None:
        super().__init__()
        self.types = types
        self._actions = ActionClient(self)

    # --- by the transport ---

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

    # --- the same for all ---

    async def run_action(self, request: ActionRequest) -> ActionEnd:
        return await self._actions.run(request)

    def serve_action(self, action: str, type_name: str, run: RunGoal) -> None:
        ActionServer(self, action, type_name, run)

    def served(self) -> list[str]:
        return named_skills(self.services())

    def kind_of(self, name: str) -> str:
        if self.serves(name):
            return "service"
        return "action" if self.serves(f"{name}/_action/send_goal") else ""

    async def check(self, name: str, type_name: str) -> None:
        if self.kind_of(name) == "action":
            name, type_name = f"{name}/_action/send_goal", f"{type_name}_SendGoal" if type_name else ""
        await self.service_type(name, type_name, 0.0)

    async def service_gone(self, service: str) -> None:
        """Returns when nobody serves it."""
        while self.serves(service):
            await self.changed()

    def _decoding(
        self, topic: str, type_name: str, take: Callable[[Fields], None]
    ) -> Callable[[bytes], None]:
        """Takes the fields of payloads; those that cannot be decoded are left out."""

        def on_payload(payload: bytes) -> None:
            try:
                fields = self.types.decoded(type_name, payload)
            except AosError as error:
                _log.warning("on %s: %s", topic, error)
            else:
                take(fields)

        return on_payload
