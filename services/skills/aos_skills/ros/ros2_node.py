"""The common part of all ROS 2 nodes: actions stand on services and topics, whatever carries these."""

import logging
from collections.abc import Callable

from aos_protocol.errors import AosError
from aos_skills.ros.actions import ActionClient, ActionServer, Ros2Services
from aos_skills.ros.node import ActionEnd, ActionRequest, Fields, RunGoal, named_skills
from aos_skills.ros.types import RosTypes

_log = logging.getLogger("aos.ros2")


class Ros2Node(Ros2Services):
    """A node over a transport that gives topics, services and who is there."""

    def __init__(self, types: RosTypes) -> None:
        super().__init__(types)
        self._actions = ActionClient(self)

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
