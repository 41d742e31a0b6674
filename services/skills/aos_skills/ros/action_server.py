"""Serving an action as a ROS 2 node does: three services, feedback and the list of goals' states."""

import asyncio
import logging
import time

from aos_protocol.errors import AosError
from aos_runtime.background import Background
from aos_skills.ros.node import Fields, Qos, RosNode, RunGoal

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
