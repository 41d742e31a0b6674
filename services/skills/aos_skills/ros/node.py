"""A ROS node as everything above it sees it, whichever way it reaches the others."""

import asyncio
from abc import abstractmethod
from collections.abc import Awaitable, Callable, Iterable
from typing import Any, NamedTuple

from aos_runtime.background import Closing

DISCOVERY_S = 5.0
"""A server or publisher may take this long to appear."""

Fields = dict[str, Any]


class Qos(NamedTuple):
    """The part of a quality of service that changes anything here; ROS 2's own default by default."""

    depth: int = 10
    is_reliable: bool = True
    is_transient_local: bool = False


DEFAULT_QOS = Qos()


class TopicFound(NamedTuple):
    """A topic that somebody publishes."""

    type_name: str
    qos: Qos


class ServiceRequest(NamedTuple):
    """A call of a service. Without a type, the server's is taken."""

    service: str
    fields: Fields
    timeout_s: float
    type_name: str = ""
    discovery_s: float = DISCOVERY_S


class ActionRequest(NamedTuple):
    """A run of an action. Without a type, the server's is taken."""

    action: str
    fields: Fields
    timeout_s: float
    type_name: str = ""
    cancelled: asyncio.Event | None = None
    on_feedback: Callable[[Fields], None] | None = None


class ActionEnd(NamedTuple):
    """The end of a goal: `succeeded`, `canceled` or `aborted`, the result's fields, its node's words."""

    status: str
    result: Fields
    text: str = ""


RunGoal = Callable[[Fields, asyncio.Event, Callable[[Fields], None]], Awaitable[Fields]]
"""Runs a goal's fields to a result, until the event says to stop; the third argument publishes feedback.

An AosError aborts the goal.
"""


class RosNode(Closing):
    """Names are full, `/robot1/chatter`; types too, `std_msgs/msg/String`; values are dicts of fields.

    `unended` are the goals that did not end when they were told to.
    """

    def __init__(self) -> None:
        self.unended = UnendedGoals()

    @abstractmethod
    def publisher(self, topic: str, type_name: str, qos: Qos = DEFAULT_QOS) -> Callable[[Fields], None]:
        """Returns a function that publishes a message on a topic."""

    @abstractmethod
    def subscribe(
        self, topic: str, type_name: str, take: Callable[[Fields], None], qos: Qos = DEFAULT_QOS
    ) -> Callable[[], None]:
        """Has each message of a topic taken until undone; those that cannot be decoded are left out.

        With a transient local quality of service, messages from before are taken as well.
        """

    @abstractmethod
    async def topic(self, topic: str, timeout_s: float) -> TopicFound | None:
        """Finds out what is published on a topic; None if nobody does within the time."""

    @abstractmethod
    async def call(self, request: ServiceRequest) -> Fields:
        """A service's response.

        SkillError AOS505 if no node serves it, AOS503 if it does not answer in time, AOS504 if it is lost.
        DeployError AOS806 if its type is not known, SkillError AOS509 if the server's definition is another.
        """

    @abstractmethod
    def serve(self, service: str, type_name: str, handler: Callable[[Fields], Awaitable[Fields]]) -> None:
        """Serves until closed: `handler(request)` runs as a task for each request and gives the response."""

    @abstractmethod
    async def run_action(self, request: ActionRequest) -> ActionEnd:
        """Sends a goal and waits for its end.

        When its `cancelled` is set, or the time is over, the goal is cancelled and its end is waited for.
        SkillError AOS505 if no node serves the action, AOS502 if it refuses the goal, AOS503 if the time was
        over, AOS504 if the node is lost or does not end the goal although it was asked to.
        """

    @abstractmethod
    def serve_action(self, action: str, type_name: str, run: RunGoal) -> None:
        """Serves an action until closed. Any number of goals may run: `run` refuses what it cannot."""

    @abstractmethod
    def served(self) -> list[str]:
        """The names of all services and actions that some node serves now, without those of every node."""

    @abstractmethod
    def kind_of(self, name: str) -> str:
        """Returns what some node serves under a name now: "service", "action", or "" for nothing."""

    def node_of(self, name: str) -> str:
        """Returns the node that serves a name now; empty where that is not known."""
        return ""

    @abstractmethod
    async def check(self, name: str, type_name: str) -> None:
        """Looks whether what is served under a name can be called.

        DeployError AOS806 if its type is not known, SkillError AOS509 if it is another than given or defined
        differently, AOS505 if nobody serves it any more.
        """

    @abstractmethod
    async def changed(self) -> None:
        """Returns at the next change of who serves and publishes what."""


_GOAL = "/_action/send_goal"
_OF_EVERY_NODE = (
    "/describe_parameters", "/get_parameter_types", "/get_parameters", "/list_parameters", "/set_parameters",
    "/set_parameters_atomically", "/get_type_description", "/get_loggers", "/set_logger_level",
)  # fmt: skip


def named_skills(services: Iterable[str]) -> list[str]:
    """Picks from the names of services those that may be skills, actions by their own names."""
    whole = {name.removesuffix(_GOAL) for name in services if "/_action/" not in name or name.endswith(_GOAL)}
    return sorted(name for name in whole if not name.endswith(_OF_EVERY_NODE))


class UnendedGoals:
    """Waits in the background for the end of each such goal. Belongs to the event loop that runs."""

    def __init__(self) -> None:
        self._waiting: dict[asyncio.Future[None], str] = {}

    def add(self, action: str, *ends: Awaitable[object]) -> None:
        """Holds a goal of this action as moving until one of these has come, as an answer or as an error."""
        task = asyncio.ensure_future(_first(ends))
        self._waiting[task] = action
        task.add_done_callback(self._waiting.pop)

    @property
    def actions(self) -> list[str]:
        """The names of the actions whose goals may still move the robot."""
        return list(self._waiting.values())

    async def close(self) -> None:
        """Waits no longer."""
        waiting = list(self._waiting)
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)


async def _first(ends: tuple[Awaitable[object], ...]) -> None:
    futures = [asyncio.ensure_future(end) for end in ends]
    try:
        await asyncio.wait(futures, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for future in futures:
            future.cancel()
        await asyncio.gather(*futures, return_exceptions=True)
