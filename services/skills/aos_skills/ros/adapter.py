"""The adapter of a robot that speaks ROS, whichever node reaches it: calls become services and actions.

Which paths there are, and which topics are listened to, the deploy file and the project's documents say. A
path is served while some node of the robot serves it.
"""

import asyncio
import json
import logging
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from aos_protocol.errors import AosError, DeployError, SkillError
from aos_runtime.adapters import Call, Host
from aos_skills.ros.connect import connect
from aos_skills.ros.documented import documented
from aos_skills.ros.faults import CANCEL_S
from aos_skills.ros.node import ActionRequest, Fields, RosNode, ServiceRequest

MAX_PROGRESS_TEXT = 120

_MARGIN_S = 0.1
_LONGER_S = 10.0
"""Deadlines are the host's; those of the questions to the robot only have to be later."""

_log = logging.getLogger("aos.ros")


class Way(NamedTuple):
    """The part of the robot that a path is bound to: a service or an action ("" if the robot says which),
    its type."""

    kind: str
    name: str
    type_name: str = ""


def way_to(path: str, target: Any) -> Way:
    """Returns what the deploy file means by a target; DeployError AOS801 if nothing."""
    if target is None:
        return Way("", path)
    if isinstance(target, str):
        return Way("", "/" + target.strip("/"))
    if isinstance(target, Mapping):
        kinds = [kind for kind in ("service", "action") if isinstance(target.get(kind), str)]
        if len(kinds) == 1 and target.keys() <= {kinds[0], "type"}:
            return Way(kinds[0], "/" + target[kinds[0]].strip("/"), str(target.get("type", "")))
    hint = "Write the name of one, or {service: /pick}, or {action: /navigate, type: package/action/Name}"
    raise DeployError(f"{path} is bound to {target!r}, which is neither a service nor an action", hint=hint)


class RosAdapter:
    """Options are those of `connect`, and `topics`: the robot's name for a topic of the documents."""

    version = "1"
    kind = ""

    def __init__(self, host: Host) -> None:
        self.host = host
        self._ways = {path: way_to(path, binding.target) for path, binding in host.bound.items()}
        self._topics: dict[str, Callable[[], None] | None] = {}
        self._serving: set[str] = set()
        self._nodes: dict[str, str] = {}
        self._told_missing = ""
        self._tasks: list[asyncio.Task[None]] = []
        self._has_new_names = asyncio.Event()
        self._serves_anew = asyncio.Lock()
        self.node: RosNode

    async def start(self) -> None:
        self.node = await connect(self.kind, f"aos_{self.host.name}", self.host.options, self.host.folder)
        self._tasks = [
            asyncio.create_task(self._follow_documents()),
            asyncio.create_task(self._follow_robot()),
        ]

    async def close(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        if hasattr(self, "node"):
            await self.node.close()

    # --- what there is ---

    async def _follow_documents(self) -> None:
        """Takes in the paths and topics of each revision of the project."""
        async for revision in self.host.revisions():
            known = documented(revision.project)
            for path in known.paths:
                if path not in self._ways and self.host.wants(path):
                    self._ways[path] = Way("", path)
            for topic in known.topics:
                self._topics.setdefault(topic, None)
            self._has_new_names.set()

    async def _follow_robot(self) -> None:
        """Serves what the robot serves, listens to what it publishes, whenever that changes."""
        while True:
            self._has_new_names.clear()
            waits = [asyncio.create_task(self.node.changed()), asyncio.create_task(_set(self._has_new_names))]
            # What changes from here on ends the waiting.
            await asyncio.sleep(0)
            try:
                async with self._serves_anew:
                    await self._serve_what_is_there()
                await self._listen_to_what_is_there()
                await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for wait in waits:
                    wait.cancel()

    async def _serve_what_is_there(self) -> None:
        self._say_what_is_missing()
        for path, way in list(self._ways.items()):
            kind = self.node.kind_of(way.name)
            is_there = bool(kind) and way.kind in ("", kind)
            if is_there:
                self._nodes[path] = self.node.node_of(way.name)
            else:
                await self.host.lack(path, self._why_missing(path, way, kind))
            if is_there and path not in self._serving:
                try:
                    await self.node.check(way.name, way.type_name)
                except DeployError as error:
                    # It can never be called: whoever starts the system has to add a file.
                    self.host.fail(error)
                    return
                except SkillError as error:
                    _log.error("%s is not served: %s", path, error)
                    await self.host.lack(path, str(error))
                    continue
                self._serving.add(path)
                # More may have come meanwhile: who sees the path served finds in the log what still is not.
                self._say_what_is_missing()
                await self.host.serve(path)
            elif not is_there and path in self._serving:
                self._serving.discard(path)
                self.host.withdraw(path)
                _log.warning("%s: %s", path, self._why_missing(path, way, kind))

    def _why_missing(self, path: str, way: Way, kind: str) -> str:
        """Tells people which node has left or serves something else, or else which services there are."""
        if kind:
            return f"{way.name} is a{'n' if kind == 'action' else ''} {kind} and no {way.kind}"
        it = "it" if way.name == path else way.name  # Then all paths of a node have one reason.
        if node := self._nodes.get(path):
            return f"the node {node} serves {it} no more: look whether it runs, and at its log"
        if path in self._nodes:
            return f"the node that served {it} has left: look whether it runs, and at its log"
        return f"no node serves {way.name}; served are {', '.join(self.node.served()) or 'none'}"

    def _say_what_is_missing(self) -> None:
        """Logs once for each change what is missing; `aos-up` shows the end of the log if a path stays
        without a server."""
        missing = [way.name for way in self._ways.values() if not self.node.kind_of(way.name)]
        if not missing:
            return
        text = f"no node serves {', '.join(missing)}; served are {', '.join(self.node.served()) or 'none'}"
        if text != self._told_missing:
            self._told_missing = text
            _log.warning("%s", text)

    async def _listen_to_what_is_there(self) -> None:
        renamed: dict[str, str] = self.host.options.get("topics", {})
        for topic, stop in list(self._topics.items()):
            name = "/" + renamed.get(topic, topic).strip("/")
            found = await self.node.topic(name, 0.0) if stop is None else None
            if found is None:
                continue

            def publish(fields: Fields, topic: str = topic) -> None:
                self.host.publish(topic, fields)

            try:
                self._topics[topic] = self.node.subscribe(name, found.type_name, publish, found.qos)
            except AosError as error:
                # It is said once, and again in the log of the next run.
                self._topics[topic] = _ignored
                _log.error("%s is not listened to: %s", name, error)

    # --- calls ---

    async def call(self, call: Call) -> dict[str, Any]:
        way = self._ways[call.path]
        kind = way.kind or self.node.kind_of(way.name)
        try:
            if kind == "action":
                return await self._run_action(call, way)
            if kind == "service":
                return await self._call_service(call, way)
        except SkillError:
            # Whoever hears of it decides for no skill of a node that has left.
            async with self._serves_anew:
                await self._serve_what_is_there()
            raise
        raise SkillError(self._why_missing(call.path, way, kind), code="AOS505")

    def still_moving(self) -> str:
        return ", ".join(self.node.unended.actions)

    async def _call_service(self, call: Call, way: Way) -> dict[str, Any]:
        try:
            return await self.node.call(
                ServiceRequest(way.name, call.fields, call.deadline_s + _LONGER_S, way.type_name)
            )
        except asyncio.CancelledError:
            message = f"the service {way.name} was given up; services of ROS cannot be cancelled"
            hint = "The robot may still move. Skills that take long are better actions"
            raise SkillError(message, code="AOS504", hint=hint) from None

    async def _run_action(self, call: Call, way: Way) -> dict[str, Any]:
        cancelled = asyncio.Event()

        def on_feedback(feedback: dict[str, Any]) -> None:
            call.progress(0.0, json.dumps(feedback, default=str)[:MAX_PROGRESS_TEXT])
            self.host.publish(f"{call.path}/feedback", feedback)

        timeout_s = call.deadline_s + _LONGER_S
        request = ActionRequest(way.name, call.fields, timeout_s, way.type_name, cancelled, on_feedback)
        running = asyncio.create_task(self.node.run_action(request))
        try:
            end = await asyncio.shield(running)
        except asyncio.CancelledError:
            cancelled.set()
            await asyncio.wait([running], timeout=CANCEL_S + _MARGIN_S)
            if running.done():
                running.result()
                raise
            # It has not even been accepted yet, or the node does not answer at all.
            running.cancel()
            message = f"the action {way.name} was to be cancelled, and its node does not answer"
            hint = "The robot may still move: look at it, and at the node's log"
            raise SkillError(message, code="AOS504", hint=hint) from None
        if end.status == "succeeded":
            return end.result
        code = "AOS507" if end.status == "canceled" else "AOS510"
        why = ": ".join(str(part) for part in (end.text, end.result) if part)
        raise SkillError(f"the action {way.name} was {end.status}: {why}", code=code)


class Ros2Adapter(RosAdapter):
    """A robot whose ROS 2 nodes run rmw_zenoh."""

    kind = "ros2"


class DdsAdapter(RosAdapter):
    """A robot whose ROS 2 nodes run Cyclone DDS, or Fast DDS for topics."""

    kind = "dds"


class Ros1Adapter(RosAdapter):
    """A robot that runs ROS 1."""

    kind = "ros1"


async def _set(event: asyncio.Event) -> None:
    await event.wait()


def _ignored() -> None:
    """Stands for a topic that cannot be listened to."""
