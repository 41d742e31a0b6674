"""The interface of an adapter, and a call as it sees it."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import msgspec

from aos_protocol.messages import ActivationId


class Observed(msgspec.Struct, frozen=True):
    """The answer of an adapter that knows the observation itself: then the mappings' rules do not run.

    `monitors` are the responses of monitors that it knows.
    """

    response: str
    numbers: dict[str, Any] = {}
    monitors: dict[str, str] = {}


Answer = Mapping[str, Any] | Observed
"""The fields of a skill's result, or the observation."""


@dataclass(eq=False)
class Call:
    """One run of a skill.

    `path` is the path of the mapping, `target` what the deploy file binds it to, by default the path itself.
    `fields` have the names that the adapter wants. `skill` and `parameters` are the action that was decided,
    and empty in a call by hand.
    """

    id: ActivationId
    path: str
    target: Any
    fields: dict[str, Any]
    deadline_s: float
    skill: str = ""
    parameters: dict[str, Any] = field(default_factory=dict)
    on_progress: Callable[[float, str], None] = lambda progress, text: None
    on_message: Callable[[str, dict[str, Any]], None] = lambda topic, fields: None
    _is_cancelled: threading.Event = field(default_factory=threading.Event, init=False)

    def progress(self, progress: float, text: str = "") -> None:
        """Tells how far it is, from 0 to 1, and what it does. From any thread, as often as you like."""
        self.on_progress(progress, text)

    def publish(self, topic: str, fields: Mapping[str, Any] | None = None, /, **more: Any) -> None:
        """Sends a message on a topic, its fields as a mapping or by name. From any thread."""
        self.on_message(topic, {**(fields or {}), **more})

    @property
    def is_cancelled(self) -> bool:
        """True where it has to stop: for code in threads, which has to look by itself."""
        return self._is_cancelled.is_set()

    def cancel(self) -> None:
        """Makes `is_cancelled` true."""
        self._is_cancelled.set()


class Adapter(Protocol):
    """A class that is made with its `Host` as the only argument. Calls come one at a time.

    `version` is told to whoever asks what serves a path.
    """

    version: str

    async def start(self) -> None:
        """Gets ready, and says what it serves with `Host.serve`. Whatever it raises ends the process."""
        ...

    async def call(self, call: Call) -> Answer:
        """Runs a skill to its end.

        SkillError AOS510 if the skill failed, AOS502 if it cannot be run at all; any other exception counts
        as AOS510. The call is cancelled by cancelling this task: stop the robot, then let `CancelledError`
        out.
        """
        ...

    async def close(self) -> None:
        """Ends the adapter; nothing runs any more."""
        ...


@runtime_checkable
class MovesOn(Protocol):
    """An adapter whose robot may go on moving after a call has ended, as one that is deaf to its end."""

    def still_moving(self) -> str:
        """Returns what may still move, for people; empty where all stands still."""
        ...
