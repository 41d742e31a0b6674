"""A robot that runs ROS 1 as a `RosNode`. Types are named as in ROS 1 or in ROS 2, `std_srvs/srv/Trigger`."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Iterable
from pathlib import Path
from typing import Any

from aos_protocol.errors import AosError
from aos_runtime.background import Background
from aos_skills.ros import faults
from aos_skills.ros.definitions import definitions_in
from aos_skills.ros.node import (
    DEFAULT_QOS,
    DISCOVERY_S,
    ActionEnd,
    ActionRequest,
    Fields,
    Qos,
    RosNode,
    RunGoal,
    ServiceRequest,
    TopicFound,
    named_skills,
)
from aos_skills.ros1.process import Ros1Process

DEFAULT_MASTER = "http://127.0.0.1:11311"
DEFAULT_PYTHON = "/usr/bin/python3"

_log = logging.getLogger("aos.ros1")


class Ros1Node(RosNode):
    """Belongs to the event loop that opened it."""

    def __init__(self) -> None:
        super().__init__()
        self._process: Ros1Process
        self._names: dict[str, dict[str, str]] = {"services": {}, "actions": {}, "topics": {}, "nodes": {}}
        self._has_changed = asyncio.Event()
        self._takers: dict[str, Callable[[Fields], None]] = {}
        self._feedback: dict[int, Callable[[Fields], None]] = {}
        self._handlers: dict[str, Callable[[Fields], Awaitable[Fields]]] = {}
        self._goals: dict[str, RunGoal] = {}
        self._stops: dict[int, asyncio.Event] = {}
        self._answering = Background()

    @classmethod
    async def open(
        cls,
        master: str = DEFAULT_MASTER,
        *,
        name: str,
        interfaces: Iterable[Path] = (),
        python: str = DEFAULT_PYTHON,
    ) -> Ros1Node:
        """Joins the system of a master; the errors are those of `Ros1Process.start`."""
        node = cls()
        files = {str(one): str(path.resolve()) for one, path in definitions_in(interfaces).items()}
        node._process = await Ros1Process.start(
            python, master, {"node": name, "files": files}, node._on_event
        )
        return node

    async def close(self) -> None:
        await self.unended.close()
        await self._answering.cancel()
        await self._process.close()

    # --- topics ---

    def publisher(self, topic: str, type_name: str, qos: Qos = DEFAULT_QOS) -> Callable[[Fields], None]:
        self._process.tell("advertise", name=topic, type=_ros1(type_name), latch=qos.is_transient_local)
        return lambda fields: self._process.tell("publish", name=topic, fields=fields)

    def subscribe(
        self, topic: str, type_name: str, take: Callable[[Fields], None], qos: Qos = DEFAULT_QOS
    ) -> Callable[[], None]:
        self._takers[topic] = take
        self._process.tell("subscribe", name=topic, type=_ros1(type_name))
        return lambda: self._takers.__setitem__(topic, _ignore)

    async def topic(self, topic: str, timeout_s: float) -> TopicFound | None:
        type_name = await self._wait_for("topics", topic, timeout_s)
        return TopicFound(type_name, DEFAULT_QOS) if type_name not in ("", "*") else None

    # --- services and actions ---

    async def call(self, request: ServiceRequest) -> Fields:
        service, timeout_s = request.service, request.timeout_s
        found = await self._type("services", service, request.type_name, min(request.discovery_s, timeout_s))
        asked = self._process.ask("call", name=service, type=found, fields=request.fields)
        try:
            response: Fields = await asyncio.wait_for(asked, timeout_s)
        except TimeoutError as error:
            raise faults.not_answered(service, timeout_s) from error
        return response

    def serve(self, service: str, type_name: str, handler: Callable[[Fields], Awaitable[Fields]]) -> None:
        self._handlers[service] = handler
        self._process.tell("serve", name=service, type=_ros1(type_name))

    async def run_action(self, request: ActionRequest) -> ActionEnd:
        loop = asyncio.get_running_loop()
        action, timeout_s = request.action, request.timeout_s
        ends_at_s = loop.time() + timeout_s
        found = await self._type("actions", action, request.type_name, min(DISCOVERY_S, timeout_s))
        number, answer = self._process.begin("run", name=action, type=found, fields=request.fields)
        self._feedback[number] = request.on_feedback or _ignore
        cancelling = asyncio.create_task(_set(request.cancelled or asyncio.Event()))
        leaving = asyncio.create_task(self._gone(action))
        try:
            await asyncio.wait(
                [answer, cancelling, leaving],
                timeout=max(ends_at_s - loop.time(), 0.0),
                return_when=asyncio.FIRST_COMPLETED,
            )
            if leaving.done() and not answer.done():
                raise faults.node_lost(action)
            is_late = not answer.done() and not cancelling.done()
            if not answer.done():
                self._process.tell("cancel", of=number)
                await asyncio.wait([answer], timeout=faults.CANCEL_S)
                if not answer.done():
                    self.unended.add(action, answer, self._gone(action))
                    raise faults.not_cancelled(action)
        finally:
            cancelling.cancel()
            leaving.cancel()
            del self._feedback[number]
        end = answer.result()
        if is_late:
            raise faults.not_ended(action, timeout_s)
        return ActionEnd(end["status"], end["result"], end["text"])

    def serve_action(self, action: str, type_name: str, run: RunGoal) -> None:
        self._goals[action] = run
        self._process.tell("serve_action", name=action, type=_ros1(type_name))

    def served(self) -> list[str]:
        return named_skills([*self._names["services"], *self._names["actions"]])

    def kind_of(self, name: str) -> str:
        if name in self._names["services"]:
            return "service"
        return "action" if name in self._names["actions"] else ""

    def node_of(self, name: str) -> str:
        return self._names["nodes"].get(name, "")

    async def check(self, name: str, type_name: str) -> None:
        kind = self.kind_of(name)
        found = await self._type(f"{kind or 'service'}s", name, type_name, 0.0)
        await self._process.ask("check", kind=kind, type=found)

    async def changed(self) -> None:
        self._has_changed.clear()
        await self._has_changed.wait()

    # --- events ---

    def _on_event(self, event: str, line: dict[str, Any]) -> None:
        if event == "names":
            self._names = line
            self._has_changed.set()
        elif event == "message":
            self._takers.get(line["name"], _ignore)(line["fields"])
        elif event == "feedback":
            self._feedback.get(line["of"], _ignore)(line["fields"])
        elif event == "stop" and line["of"] in self._stops:
            self._stops[line["of"]].set()
        elif event in ("request", "goal"):
            self._answering.begin(self._answer(event, line))

    async def _answer(self, event: str, line: dict[str, Any]) -> None:
        number, name = line["of"], line["name"]
        stop = self._stops[number] = asyncio.Event()
        fields: Fields = {}
        error = ""
        try:
            if event == "request":
                fields = await self._handlers[name](line["fields"])
            else:
                fields = await self._goals[name](
                    line["fields"], stop, lambda one: self._process.tell("feedback", of=number, fields=one)
                )
        except AosError as failure:
            error = str(failure)
        except Exception as failure:
            _log.exception("%s failed", name)
            error = f"{type(failure).__name__}: {failure}"
        finally:
            del self._stops[number]
        self._process.tell("answer", of=number, fields=fields, error=error)

    # --- names ---

    async def _gone(self, action: str) -> None:
        while action in self._names["actions"]:
            await self.changed()

    async def _wait_for(self, kind: str, name: str, timeout_s: float) -> str:
        try:
            async with asyncio.timeout(timeout_s):
                while not self._names[kind].get(name):
                    await self.changed()
        except TimeoutError:
            return ""
        return self._names[kind][name]

    async def _type(self, kind: str, name: str, type_name: str, timeout_s: float) -> str:
        found = await self._wait_for(kind, name, timeout_s)
        if not found:
            raise faults.not_served(f"no ROS 1 node serves {name}", sorted(self._names[kind]))
        faults.check_type(name, found, _ros1(type_name) if type_name else "")
        return found


def _ros1(type_name: str) -> str:
    """`std_srvs/srv/Trigger` as ROS 1 writes it."""
    parts = type_name.split("/")
    return f"{parts[0]}/{parts[-1]}"


def _ignore(_: Fields) -> None:
    """Takes messages that nobody wants any more."""


async def _set(event: asyncio.Event) -> None:
    await event.wait()
