"""Running an action of a ROS 2 node: goal, feedback, result, and the handshake of cancelling."""

from __future__ import annotations

import asyncio
import uuid
from collections.abc import Callable
from typing import Protocol

from aos_protocol.errors import AosError, SkillError
from aos_skills.ros.node import DISCOVERY_S, ActionEnd, Fields, RosNode

__all__ = ["STATUS", "Feedback", "ServiceNode", "run_action"]

STATUS = {
    1: "accepted",
    2: "executing",
    3: "canceling",
    4: "succeeded",
    5: "canceled",
    6: "aborted",
}

CANCEL_S = 1.8
"""A node may take this long to end a goal after it was asked to: less than an adapter has for it."""


class ServiceNode(RosNode, Protocol):
    """A node of ROS 2, where actions are made of services and topics."""

    async def service_type(self, service: str, type_name: str, timeout_s: float) -> str:
        """The type of a service that some node serves, which is as it is defined here, and the given one.

        The errors are those of `RosNode.call`.
        """
        ...

    async def until_heard(self, topic: str) -> None:
        """Returns when what is published on a topic that is subscribed to arrives, as far as can be known."""
        ...

    async def service_gone(self, service: str) -> None:
        """Returns once no node serves the service."""
        ...


class Feedback:
    """The takers of feedback by goal: one subscription for each action, however many goals run."""

    def __init__(self) -> None:
        self._takers: dict[str, dict[bytes, Callable[[Fields], None]]] = {}

    async def listen(
        self, node: ServiceNode, action: str, type_name: str, goal: bytes, take: Callable[[Fields], None]
    ) -> None:
        """Has a goal's feedback taken until it is forgotten."""
        if action not in self._takers:
            takers = self._takers[action] = {}

            def on_message(message: Fields) -> None:
                takers.get(bytes(message["goal_id"]["uuid"]), _ignore)(message["feedback"])

            topic = f"{action}/_action/feedback"
            node.subscribe(topic, f"{type_name}_FeedbackMessage", on_message)
            await node.until_heard(topic)
        self._takers[action][goal] = take

    def forget(self, action: str, goal: bytes) -> None:
        """Nobody takes this goal's feedback any more."""
        self._takers.get(action, {}).pop(goal, None)


async def run_action(
    node: ServiceNode,
    all_feedback: Feedback,
    action: str,
    goal: Fields,
    *,
    type_name: str = "",
    timeout_s: float,
    cancelled: asyncio.Event | None = None,
    on_feedback: Callable[[Fields], None] | None = None,
) -> ActionEnd:
    """`RosNode.run_action` for ROS 2."""
    loop = asyncio.get_running_loop()
    ends_at_s = loop.time() + timeout_s
    goal_type = await node.service_type(
        f"{action}/_action/send_goal",
        f"{type_name}_SendGoal" if type_name else "",
        min(DISCOVERY_S, timeout_s),
    )
    type_name = goal_type.removesuffix("_SendGoal")
    goal_key = uuid.uuid4().bytes
    goal_id = {"uuid": list(goal_key)}
    await all_feedback.listen(node, action, type_name, goal_key, on_feedback or _ignore)
    try:
        accepted = await node.call(
            f"{action}/_action/send_goal",
            {"goal_id": goal_id, "goal": goal},
            type_name=f"{type_name}_SendGoal",
            timeout_s=max(ends_at_s - loop.time(), 0.1),
        )
        if not accepted["accepted"]:
            raise SkillError(f"{action} refused the goal", code="AOS502", hint="See the node's log")
        async with asyncio.TaskGroup() as tasks:
            # It is answered at the goal's end, and outlives the deadline by that of cancelling.
            result = tasks.create_task(
                node.call(
                    f"{action}/_action/get_result",
                    {"goal_id": goal_id},
                    type_name=f"{type_name}_GetResult",
                    timeout_s=max(ends_at_s - loop.time(), 0.0) + 2 * CANCEL_S,
                )
            )
            reason = await _ended(node, action, result, cancelled, ends_at_s - loop.time())
            if reason == "lost":
                result.cancel()
                raise _lost(action)
            if reason:
                await _cancel(node, action, goal_id, result)
    except* AosError as group:
        raise _first(group) from None
    finally:
        all_feedback.forget(action, goal_key)
    end = result.result()
    if reason == "late":
        raise SkillError(f"{action} did not end within {timeout_s:g} s and was cancelled", code="AOS503")
    return ActionEnd(STATUS.get(end["status"], "aborted"), end["result"])


async def _ended(
    node: ServiceNode,
    action: str,
    result: asyncio.Task[Fields],
    cancelled: asyncio.Event | None,
    timeout_s: float,
) -> str:
    """Waits and returns why waiting has ended: "" with the result, else "cancelled", "late" or "lost"."""

    cancelling = asyncio.ensure_future((cancelled or asyncio.Event()).wait())
    leaving = asyncio.ensure_future(node.service_gone(f"{action}/_action/get_result"))
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


async def _cancel(node: ServiceNode, action: str, goal_id: Fields, result: asyncio.Task[Fields]) -> None:
    """Asks for the goal's end and waits for it; SkillError AOS504 if it does not come."""
    try:
        async with asyncio.timeout(CANCEL_S):
            await node.call(
                f"{action}/_action/cancel_goal",
                {"goal_info": {"goal_id": goal_id}},
                type_name="action_msgs/srv/CancelGoal",
                timeout_s=CANCEL_S,
            )
            await asyncio.wait([result])
    except (TimeoutError, SkillError) as error:
        result.cancel()
        raise SkillError(
            f"{action} was asked to cancel its goal and did not within {CANCEL_S:g} s",
            code="AOS504",
            hint="The robot may still move: look at it, and at the node's log",
        ) from error


def _ignore(_: Fields) -> None:
    """Takes feedback that nobody wants."""


def _lost(action: str) -> SkillError:
    return SkillError(
        f"the node that serves {action} has left while it ran",
        code="AOS504",
        hint="Whether the skill did its work is not known",
    )


def _first(group: BaseExceptionGroup[AosError]) -> AosError:
    inner = group.exceptions[0]
    return _first(inner) if isinstance(inner, BaseExceptionGroup) else inner
