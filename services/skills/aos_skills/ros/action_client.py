"""Running an action of a ROS 2 node: goal, feedback, result, and the handshake of cancelling."""

import asyncio
import uuid
from collections.abc import Callable

from aos_protocol.errors import AosError, SkillError
from aos_skills.ros.faults import CANCEL_S, goal_forgotten, node_lost, not_cancelled, not_ended
from aos_skills.ros.node import DISCOVERY_S, ActionEnd, ActionRequest, Fields, ServiceRequest
from aos_skills.ros.ros2_services import Ros2Services

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
