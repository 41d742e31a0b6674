"""The parts of rospy, actionlib and generated messages that are used here, as types: none of them has any."""

from __future__ import annotations

from typing import Any, Callable, Dict, Protocol, Type

Fields = Dict[str, Any]
"""A message as plain data."""


class Channel(Protocol):
    """The lines to AOS."""

    def send(self, **line: Any) -> None: ...


class Message(Protocol):
    """An object of a message's class. The names of its fields are its slots."""

    __slots__: list[str]
    _type: str
    _slot_types: list[str]
    _full_text: str


class GoalMessage(Message, Protocol):
    """A goal with its header, as actionlib sends it."""

    goal: Message


class ResultMessage(Message, Protocol):
    result: Message


class FeedbackMessage(Message, Protocol):
    feedback: Message


class Service(Protocol):
    _request_class: Type[Message]
    _response_class: Type[Message]


class Publisher(Protocol):
    """A topic that messages of one class are sent on."""

    data_class: Type[Message]

    def publish(self, message: Message) -> None: ...


class ActionClient(Protocol):
    """`actionlib.SimpleActionClient`: one goal."""

    def wait_for_server(self, timeout: Any) -> bool: ...

    def send_goal(
        self, goal: Message, done_cb: Callable[[int, Message], None], feedback_cb: Callable[[Message], None]
    ) -> None: ...

    def cancel_goal(self) -> None: ...

    def get_state(self) -> int: ...

    def get_result(self) -> Message | None: ...

    def get_goal_status_text(self) -> str: ...


class ActionServer(Protocol):
    """`actionlib.SimpleActionServer`: one goal at a time."""

    def start(self) -> None: ...

    def is_preempt_requested(self) -> bool: ...

    def publish_feedback(self, feedback: Message) -> None: ...

    def set_preempted(self, result: Message, text: str) -> None: ...

    def set_aborted(self, result: Message, text: str) -> None: ...

    def set_succeeded(self, result: Message) -> None: ...


Kept = object
"""Something of rospy's that works as long as somebody refers to it."""
