"""The requests of AOS to a robot that runs ROS 1, done with rospy: services, actions and topics, both
ways."""

from __future__ import annotations

import re
import threading
from typing import Callable, TypedDict

import actionlib
import rosgraph
import rospy
from actionlib_msgs.msg import GoalStatus

from aos_skills.ros1.child.interfaces import (
    ActionClient,
    ActionServer,
    Channel,
    Fields,
    Kept,
    Message,
    Publisher,
)
from aos_skills.ros1.child.names import Names
from aos_skills.ros1.child.types import ActionClasses, Misfit, Types, Unknown, plain

QUEUE = 1000
SERVER_S = 5.0

STATUS = {
    GoalStatus.SUCCEEDED: "succeeded",
    GoalStatus.PREEMPTED: "canceled",
    GoalStatus.RECALLED: "canceled",
}


OnFeedback = Callable[[Fields], None]


class Settings(TypedDict):
    """The name of the node, and the paths of interface files by `package/kind/Name`."""

    node: str
    files: dict[str, str]


class Refusal(Exception):
    """An error with a code of AOS."""

    def __init__(self, code: str, text: str, hint: str = "") -> None:
        super().__init__(text)
        self.code = code
        self.hint = hint


class Robot:
    """Its methods `do_X` answer the requests X."""

    def __init__(self, channel: Channel, settings: Settings) -> None:
        self._channel = channel
        self._types = Types(settings["files"])
        self._clients: dict[int, ActionClient] = {}
        self._cancelled: set[int] = set()
        self._publishers: dict[str, Publisher] = {}
        self._asked: dict[int, _Asked] = {}
        self._asked_lock = threading.Lock()
        self._asked_count = 0
        self._kept: list[Kept] = []
        rosgraph.Master("/aos").getPid()  # Without a master rospy would wait for one, for ever.
        rospy.init_node(settings["node"], anonymous=True, disable_signals=True)
        self._names = Names(channel, rospy.get_name())
        threading.Thread(target=self._names.follow, daemon=True).start()

    def code_of(self, error: Exception) -> tuple[str, str]:
        """The code of AOS for an exception, and what to do."""
        if isinstance(error, Refusal):
            return error.code, error.hint
        if isinstance(error, Unknown):
            return "AOS806", ""
        if isinstance(error, (Misfit, rospy.ROSSerializationException)):
            return "AOS502", ""
        return "AOS510", ""

    # --- as a client ---

    def do_check(self, number: int, kind: str, type: str) -> None:
        if kind == "action":
            ActionClasses(self._types, type)
        else:
            self._types.service(type)

    def do_call(self, number: int, name: str, type: str, fields: Fields) -> Fields:
        cls = self._types.service(type)
        request = self._types.filled(cls._request_class(), fields)
        try:
            response: Fields = plain(rospy.ServiceProxy(name, cls).call(request))
        except rospy.ServiceException as error:
            text = re.sub(r"""b(['"])(.*)\1$""", r"\2", str(error))
            if "responded with an error" in text:
                raise Refusal("AOS510", f"{name} failed: {text.partition(': ')[2] or text}")
            self._names.look_after_loss(name)  # That its node has left is told before the call fails.
            if "unable to connect" in text or "unavailable" in text:
                raise Refusal("AOS505", f"{name} cannot be reached: {text}", self._names.advice(name))
            raise Refusal("AOS504", f"{name} was lost during the call: {text}")
        return response

    def do_run(self, number: int, name: str, type: str, fields: Fields) -> Fields:
        spec = ActionClasses(self._types, type)
        client: ActionClient = actionlib.SimpleActionClient(name, _ActionSpec(spec))
        if not client.wait_for_server(rospy.Duration(SERVER_S)):
            raise Refusal("AOS505", f"the action {name} does not answer", self._names.advice(name))
        ended = threading.Event()
        goal = self._types.filled(spec.action_goal.goal.__class__(), fields)
        self._clients[number] = client
        try:
            if number in self._cancelled:
                raise Refusal("AOS507", f"{name} was cancelled before it got its goal")
            client.send_goal(
                goal,
                done_cb=lambda _status, _result: ended.set(),
                feedback_cb=lambda one: self._channel.send(event="feedback", of=number, fields=plain(one)),
            )
            if number in self._cancelled:  # While the goal was on its way.
                client.cancel_goal()
            ended.wait()
        finally:
            del self._clients[number]
            self._cancelled.discard(number)
        status = client.get_state()
        if status == GoalStatus.REJECTED:
            raise Refusal("AOS502", f"{name} refused the goal: {client.get_goal_status_text()}")
        if status == GoalStatus.LOST:
            raise Refusal("AOS504", f"the node that serves {name} was lost")
        result = client.get_result()
        return {
            "status": STATUS.get(status, "aborted"),
            "result": plain(result) if result is not None else {},
            "text": client.get_goal_status_text(),
        }

    def do_cancel(self, number: int, of: int) -> None:
        self._cancelled.add(of)
        client = self._clients.get(of)
        if client is not None:
            client.cancel_goal()

    def do_subscribe(self, number: int, name: str, type: str) -> None:
        cls = self._types.message(type)

        def on_message(message: Message) -> None:
            self._channel.send(event="message", name=name, fields=plain(message))

        self._kept.append(rospy.Subscriber(name, cls, on_message, queue_size=QUEUE))

    # --- as a server ---

    def do_advertise(self, number: int, name: str, type: str, latch: bool) -> None:
        self._publishers[name] = rospy.Publisher(
            name, self._types.message(type), latch=latch, queue_size=QUEUE
        )

    def do_publish(self, number: int, name: str, fields: Fields) -> None:
        publisher = self._publishers[name]
        publisher.publish(self._types.filled(publisher.data_class(), fields))

    def do_serve(self, number: int, name: str, type: str) -> None:
        cls = self._types.service(type)

        def handle(request: Message) -> Message:
            asked = self._ask("request", name, plain(request))
            asked.has_answer.wait()
            if asked.error:
                # rospy tells the caller what is raised here.
                raise rospy.ServiceException(asked.error)
            return self._types.filled(cls._response_class(), asked.fields)

        self._kept.append(rospy.Service(name, cls, handle))

    def do_serve_action(self, number: int, name: str, type: str) -> None:
        spec = ActionClasses(self._types, type)

        def execute(goal: Message) -> None:
            asked = self._ask("goal", name, plain(goal), publish)
            while not asked.has_answer.wait(0.02):
                if server.is_preempt_requested() and not asked.is_stopped:
                    asked.is_stopped = True
                    self._channel.send(event="stop", of=asked.number)
            result = self._types.filled(spec.action_result.result.__class__(), asked.fields)
            if asked.is_stopped:
                server.set_preempted(result, asked.error)
            elif asked.error:
                server.set_aborted(result, asked.error)
            else:
                server.set_succeeded(result)

        def publish(fields: Fields) -> None:
            server.publish_feedback(self._types.filled(spec.action_feedback.feedback.__class__(), fields))

        server: ActionServer = actionlib.SimpleActionServer(
            name, _ActionSpec(spec), execute, auto_start=False
        )
        server.start()
        self._kept.append(server)

    def _ask(self, event: str, name: str, fields: Fields, on_feedback: OnFeedback | None = None) -> _Asked:
        with self._asked_lock:
            self._asked_count += 1
            asked = self._asked[self._asked_count] = _Asked(self._asked_count, on_feedback)
        self._channel.send(event=event, of=asked.number, name=name, fields=fields)
        return asked

    def do_answer(self, number: int, of: int, fields: Fields, error: str) -> None:
        asked = self._asked.pop(of)
        asked.fields, asked.error = fields, error
        asked.has_answer.set()

    def do_feedback(self, number: int, of: int, fields: Fields) -> None:
        asked = self._asked.get(of)
        if asked is not None and asked.on_feedback is not None:
            asked.on_feedback(fields)


class _Asked:
    """A request or a goal of the robot's others, which AOS answers."""

    def __init__(self, number: int, on_feedback: OnFeedback | None) -> None:
        self.number = number
        self.on_feedback = on_feedback
        self.has_answer = threading.Event()
        self.is_stopped = False
        self.fields: Fields = {}
        self.error = ""


def _ActionSpec(classes: ActionClasses) -> Callable[[], ActionClasses]:
    """actionlib makes an object of what it is given."""
    return lambda: classes
