"""The common part of all ROS 2 nodes: actions stand on services and topics, whatever carries these."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Awaitable, Callable, Iterable

from aos_protocol.errors import SkillError
from aos_runtime.closing import Closing
from aos_skills.ros.action_client import ActionClient
from aos_skills.ros.action_server import ActionServer
from aos_skills.ros.node import (
    DEFAULT_QOS,
    ActionEnd,
    ActionRequest,
    Fields,
    Qos,
    RunGoal,
    ServiceRequest,
    TopicFound,
    named_skills,
)
from aos_skills.ros.types import RosTypes

__all__ = ["Ros2Node", "check_type", "not_served"]


class Ros2Node(Closing):
    """A `RosNode` over a transport that gives topics, services and who is there; see `RosNode` for each."""

    def __init__(self, types: RosTypes) -> None:
        self.types = types
        self._actions = ActionClient(self)

    # --- by the transport ----------------------------------------------------------------------------

    @abstractmethod
    def publisher(self, topic: str, type_name: str, qos: Qos = DEFAULT_QOS) -> Callable[[Fields], None]: ...

    @abstractmethod
    def subscribe(
        self, topic: str, type_name: str, take: Callable[[Fields], None], qos: Qos = DEFAULT_QOS
    ) -> Callable[[], None]: ...

    @abstractmethod
    async def until_heard(self, topic: str) -> None:
        """Returns when whoever publishes a topic knows of the subscription to it."""

    @abstractmethod
    async def topic(self, topic: str, timeout_s: float) -> TopicFound | None: ...

    @abstractmethod
    async def call(self, request: ServiceRequest) -> Fields: ...

    @abstractmethod
    def serve(self, service: str, type_name: str, handler: Callable[[Fields], Awaitable[Fields]]) -> None: ...

    @abstractmethod
    async def service_type(self, service: str, type_name: str, timeout_s: float) -> str:
        """The type of a service, as it is defined here; SkillError AOS505 or AOS509."""

    @abstractmethod
    def serves(self, service: str) -> bool:
        """Returns whether some node serves it now."""

    @abstractmethod
    def services(self) -> list[str]:
        """The names of all that some node serves now."""

    @abstractmethod
    async def changed(self) -> None: ...

    @abstractmethod
    async def close(self) -> None: ...

    # --- the same for all ----------------------------------------------------------------------------

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


def not_served(message: str, known: Iterable[str]) -> SkillError:
    """The error where no node serves what is called."""
    return SkillError(message, code="AOS505", hint=f"Served are: {', '.join(known) or 'none'}")


def check_type(service: str, found: str, wanted: str) -> None:
    """Raises SkillError AOS509 where a service is of another type than the wanted one, if any is."""
    if wanted and found != wanted:
        raise SkillError(
            f"{service} is of type {found}, not {wanted}",
            code="AOS509",
            hint="Correct the type in the deploy file, or leave it out",
        )
