"""Actions of ROS 2 nodes, run and served: goal, feedback, result, and the handshake of cancelling."""

import asyncio
import logging
import time
import uuid
from abc import abstractmethod
from collections.abc import Callable

from aos_protocol.errors import AosError, SkillError
from aos_runtime.background import Background
from aos_skills.ros.faults import CANCEL_S, goal_forgotten, node_lost, not_cancelled, not_ended
from aos_skills.ros.node import (
    DISCOVERY_S,
    ActionEnd,
    ActionRequest,
    Fields,
    Qos,
    RosNode,
    RunGoal,
    ServiceRequest,
)
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


_ASKED_S = 24 * 3600.0
"""A goal that did not end when it was told to may take this long to end after all."""

ENDED = {4: "succeeded", 5: "canceled", 6: "aborted"}
"""The states in which a goal has ended. A node that does not know the goal says 0."""


class ActionClient:
    """A node's runs of actions, with one subscription to feedback for each action, however many goals run."""

    def __init__(self, node: Ros2Services) -> None:
        self._node = node
        self._takers: dict[str, dict[bytes, Callable[[Fields], None]]] = {}

    async def run(self, request: ActionRequest) -> ActionEnd:
        """`RosNode.run_action` for ROS 2."""
        loop = asyncio.get_running_loop()
        action, ends_at_s = request.action, loop.time() + request.timeout_s
        goal_type = await self._node.service_type(
            f"{action}/_action/send_goal",
            f"{request.type_name}_SendGoal" if request.type_name else "",
            min(DISCOVERY_S, request.timeout_s),
        )
        type_name = goal_type.removesuffix("_SendGoal")
        goal_key = uuid.uuid4().bytes
        goal_id = {"uuid": list(goal_key)}
        await self._listen(action, type_name, goal_key, request.on_feedback or _ignore)
        try:
            fields = {"goal_id": goal_id, "goal": request.fields}
            accepted = await self._ask(
                action, "send_goal", fields, goal_type, max(ends_at_s - loop.time(), 0.1)
            )
            if not accepted["accepted"]:
                raise SkillError(f"{action} refused the goal", hint="See the node's log")
            async with asyncio.TaskGroup() as tasks:
                # It is answered at the goal's end, and outlives the deadline by that of cancelling.
                timeout_s = max(ends_at_s - loop.time(), 0.0) + 2 * CANCEL_S
                asking = self._ask(
                    action, "get_result", {"goal_id": goal_id}, f"{type_name}_GetResult", timeout_s
                )
                result = tasks.create_task(asking)
                reason = await self._ended(action, result, request.cancelled, ends_at_s - loop.time())
                if reason == "lost":
                    result.cancel()
                    raise node_lost(action)
                if reason:
                    await self._cancel(action, goal_id, result, f"{type_name}_GetResult")
        except asyncio.CancelledError:
            # It may have been accepted. A node that knows no such goal says so at once.
            self._doubt(action, goal_id, f"{type_name}_GetResult")
            raise
        except ExceptionGroup as group:
            known, others = group.split(AosError)
            if known is None or others is not None:
                raise
            raise _first(known) from None
        finally:
            self._takers.get(action, {}).pop(goal_key, None)
        end = result.result()
        if reason == "late":
            raise not_ended(action, request.timeout_s)
        if end["status"] not in ENDED:
            raise goal_forgotten(action)
        return ActionEnd(ENDED[end["status"]], end["result"])

    async def _listen(self, action: str, type_name: str, goal: bytes, take: Callable[[Fields], None]) -> None:
        """Has a goal's feedback taken until it is forgotten."""
        if action not in self._takers:
            takers = self._takers[action] = {}

            def on_message(message: Fields) -> None:
                takers.get(bytes(message["goal_id"]["uuid"]), _ignore)(message["feedback"])

            topic = f"{action}/_action/feedback"
            self._node.subscribe(topic, f"{type_name}_FeedbackMessage", on_message)
            await self._node.until_heard(topic)
        self._takers[action][goal] = take

    async def _ask(self, action: str, part: str, fields: Fields, type_name: str, timeout_s: float) -> Fields:
        request = ServiceRequest(f"{action}/_action/{part}", fields, timeout_s, type_name)
        return await self._node.call(request)

    async def _ended(
        self, action: str, result: asyncio.Task[Fields], cancelled: asyncio.Event | None, timeout_s: float
    ) -> str:
        """Waits and returns why waiting has ended: "" with the result, else "cancelled", "late" or "lost"."""

        cancelling = asyncio.ensure_future((cancelled or asyncio.Event()).wait())
        leaving = asyncio.ensure_future(self._node.service_gone(f"{action}/_action/get_result"))
        try:
            await asyncio.wait(
                [result, cancelling, leaving],
                timeout=max(timeout_s, 0.0),
                return_when=asyncio.FIRST_COMPLETED,
            )
        finally:
            cancelling.cancel()
            leaving.cancel()
        if result.done():
            return ""
        if leaving.done():
            return "lost"
        return "cancelled" if cancelling.done() else "late"

    async def _cancel(
        self, action: str, goal_id: Fields, result: asyncio.Task[Fields], result_type: str
    ) -> None:
        """Asks for the goal's end and waits for it; SkillError AOS504 if it does not come."""
        try:
            async with asyncio.timeout(CANCEL_S):
                fields = {"goal_info": {"goal_id": goal_id}}
                await self._ask(action, "cancel_goal", fields, "action_msgs/srv/CancelGoal", CANCEL_S)
                await asyncio.wait([result])
        except (TimeoutError, SkillError) as error:
            result.cancel()
            self._doubt(action, goal_id, result_type)
            raise not_cancelled(action) from error

    def _doubt(self, action: str, goal_id: Fields, result_type: str) -> None:
        """Holds a goal as one that may move the robot until it has ended or its node has left."""
        ending = self._ask(action, "get_result", {"goal_id": goal_id}, result_type, _ASKED_S)
        self._node.unended.add(action, ending, self._node.service_gone(f"{action}/_action/get_result"))


def _ignore(_: Fields) -> None:
    """Takes feedback that nobody wants."""


def _first(group: BaseExceptionGroup[AosError]) -> AosError:
    inner = group.exceptions[0]
    return _first(inner) if isinstance(inner, BaseExceptionGroup) else inner


_ACCEPTED, _EXECUTING, _CANCELING, _SUCCEEDED, _CANCELED, _ABORTED = range(1, 7)
_NO_ERROR, _REJECTED, _UNKNOWN_GOAL, _TERMINATED = range(4)

_KEPT_GOALS = 50
"""Ended goals whose results can still be asked for."""

_log = logging.getLogger("aos.ros.server")


class Goal:
    """One goal: its id, its state, and whether it is to be cancelled."""

    def __init__(self, id: list[int]) -> None:
        self.id = id
        self.status = _ACCEPTED
        self.accepted_ns = time.time_ns()
        self.cancelled = asyncio.Event()
        self.result: Fields = {}
        self.has_ended = asyncio.Event()

    @property
    def info(self) -> Fields:
        """The goal as messages name it."""
        return {"goal_id": {"uuid": self.id}, "stamp": _stamp(self.accepted_ns)}


class ActionServer:
    """Serves until the node closes. Any number of goals may run: `run` refuses what it cannot."""

    def __init__(self, node: RosNode, action: str, type_name: str, run: RunGoal) -> None:
        self._action = action
        self._run = run
        self._goals: dict[bytes, Goal] = {}
        self._running = Background()
        self._feedback = node.publisher(f"{action}/_action/feedback", f"{type_name}_FeedbackMessage")
        self._status = node.publisher(
            f"{action}/_action/status",
            "action_msgs/msg/GoalStatusArray",
            Qos(depth=1, is_transient_local=True),
        )
        node.serve(f"{action}/_action/send_goal", f"{type_name}_SendGoal", self._accept)
        node.serve(f"{action}/_action/cancel_goal", "action_msgs/srv/CancelGoal", self._cancel)
        node.serve(f"{action}/_action/get_result", f"{type_name}_GetResult", self._give_result)

    async def _accept(self, request: Fields) -> Fields:
        goal = Goal(request["goal_id"]["uuid"])
        if bytes(goal.id) in self._goals:
            return {"accepted": False}
        self._goals[bytes(goal.id)] = goal
        self._running.begin(self._execute(goal, request["goal"]))
        return {"accepted": True, "stamp": _stamp(goal.accepted_ns)}

    async def _execute(self, goal: Goal, fields: Fields) -> None:
        self._tell(goal, _EXECUTING)
        try:
            goal.result = await self._run(
                fields,
                goal.cancelled,
                lambda feedback: self._feedback({"goal_id": {"uuid": goal.id}, "feedback": feedback}),
            )
        except AosError as error:
            status = _CANCELED if goal.cancelled.is_set() else _ABORTED
            if status == _ABORTED:  # The action's messages have no field for the reason.
                _log.warning("a goal of %s is aborted: %s", self._action, error)
        else:
            status = _CANCELED if goal.cancelled.is_set() else _SUCCEEDED
        self._tell(goal, status)
        goal.has_ended.set()
        for key in [key for key, known in self._goals.items() if known.has_ended.is_set()][:-_KEPT_GOALS]:
            del self._goals[key]

    def _tell(self, goal: Goal, status: int) -> None:
        goal.status = status
        listed = [{"goal_info": known.info, "status": known.status} for known in self._goals.values()]
        self._status({"status_list": listed})

    async def _cancel(self, request: Fields) -> Fields:
        asked = bytes(request["goal_info"]["goal_id"]["uuid"])
        # All zeros stand for every goal.
        goals = [self._goals[asked]] if asked in self._goals else []
        if not any(asked):
            goals = list(self._goals.values())
        elif not goals:
            return {"return_code": _UNKNOWN_GOAL}
        running = [goal for goal in goals if not goal.has_ended.is_set()]
        if not running:
            return {"return_code": _TERMINATED}
        for goal in running:
            self._tell(goal, _CANCELING)
            goal.cancelled.set()
        return {"return_code": _NO_ERROR, "goals_canceling": [goal.info for goal in running]}

    async def _give_result(self, request: Fields) -> Fields:
        goal = self._goals.get(bytes(request["goal_id"]["uuid"]))
        if goal is None:
            return {"status": 0}
        await goal.has_ended.wait()
        return {"status": goal.status, "result": goal.result}


def _stamp(time_ns: int) -> Fields:
    return {"sec": time_ns // 10**9, "nanosec": time_ns % 10**9}
