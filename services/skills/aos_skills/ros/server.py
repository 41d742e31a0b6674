"""Serves what AOS's adapters can do, as services, actions and topics of a robot that speaks ROS.

`python -m aos_skills.ros.server SETTINGS.json`. It is a client of the bus like any other: whatever adapter
answers a path, and our simulated worlds first of all, can so be tried by somebody's ROS programs.
"""

import asyncio
import itertools
import logging
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from aos_protocol.errors import AosError
from aos_protocol.messages import ActivationId, Cancel, Cancelled, SkillCall, SkillResult, TopicMessage
from aos_runtime.processes.lifecycle import Service, run_service
from aos_runtime.processes.settings import ServiceSettings
from aos_skills.ros.connect import connect
from aos_skills.ros.node import Fields, RosNode

_GRACE_S = 5.0
"""The adapter's own deadlines come first."""

_log = logging.getLogger("aos.ros.server")


class ServerSettings(ServiceSettings, frozen=True, kw_only=True):
    """`types` gives each path or topic its ROS type. A call may take `timeout_s`."""

    kind: str
    folder: str = ""
    options: dict[str, Any] = msgspec.field(default_factory=dict)
    types: dict[str, str] = msgspec.field(default_factory=dict)
    timeout_s: float = 600.0


async def serve(service: Service[ServerSettings]) -> None:
    """Serves until stopped: a path once an adapter serves it, a topic at once."""
    settings = service.settings
    node = await connect(settings.kind, settings.robot, settings.options, Path(settings.folder))
    server = _Server(service, node)
    try:
        async with asyncio.TaskGroup() as tasks:
            for name, type_name in settings.types.items():
                if "/msg/" in type_name:
                    tasks.create_task(server.forward(name, node.publisher(name, type_name)))
            await service.ready()
            await server.serve_paths()
    finally:
        await node.close()


class _Server:
    def __init__(self, service: Service[ServerSettings], node: RosNode) -> None:
        self._bus = service.bus
        self._keys = service.keys
        self._settings = service.settings
        self._node = node
        # Activations of others have ids of their own.
        self._mission = f"{service.settings.kind}-{uuid.uuid4().hex[:12]}"
        self._steps = itertools.count(1)

    async def forward(self, topic: str, publish: Callable[[Fields], None]) -> None:
        """Publishes every message of a topic; those that do not fit the type are logged once."""
        has_failed = False
        async with self._bus.listen(self._keys.topic(topic), TopicMessage) as messages:
            async for _, message in messages:
                try:
                    publish(message.fields)
                except AosError as error:
                    if not has_failed:
                        _log.error("%s cannot be published: %s", topic, error)
                    has_failed = True

    async def serve_paths(self) -> None:
        """Serves each path from when an adapter has said that it does."""
        served: set[str] = set()
        async with self._bus.presence(self._keys.all_serve) as changes:
            async for key, is_alive in changes:
                serving = self._keys.serving_of(key)
                if serving is None or not is_alive or serving.path in served:
                    continue
                served.add(serving.path)
                self._serve(serving.path, self._settings.types.get(serving.path, ""))

    def _serve(self, path: str, type_name: str) -> None:
        if "/srv/" in type_name:

            async def respond(request: Fields) -> Fields:
                try:
                    return await self._call(path, request)
                except AosError as error:
                    return self._failure(type_name, error)

            self._node.serve(path, type_name, respond)
        elif "/action/" in type_name:

            async def run(goal: Fields, stop: asyncio.Event, _: Callable[[Fields], None]) -> Fields:
                return await self._run(path, goal, stop)

            self._node.serve_action(path, type_name, run)
        else:
            _log.warning("%s has no type and is not served", path)
            return
        _log.info("%s is served as %s", path, type_name)

    def _failure(self, type_name: str, error: AosError) -> Fields:
        """Tells the caller that a service failed: ROS 1 has errors for it, ROS 2 only fields of the
        response."""
        types = getattr(self._node, "types", None)
        names = {field.name for field in types.fields(f"{type_name}_Response")} if types else set()
        if "success" not in names:
            raise error
        return {"success": False} | ({"message": str(error)} if "message" in names else {})

    async def _run(self, path: str, goal: Fields, stop: asyncio.Event) -> Fields:
        calling = asyncio.create_task(self._call(path, goal))
        stopping = asyncio.create_task(stop.wait())
        try:
            await asyncio.wait([calling, stopping], return_when=asyncio.FIRST_COMPLETED)
            if not calling.done():
                await self._bus.ask(
                    self._keys.cancel(path), Cancel("cancelled by a ROS node"), Cancelled, timeout_s=_GRACE_S
                )
        finally:
            stopping.cancel()
        return await calling

    async def _call(self, path: str, fields: Fields) -> Fields:
        call = SkillCall(
            ActivationId(self._mission, next(self._steps)), path, fields, self._settings.timeout_s
        )
        try:
            result = await self._bus.ask(
                self._keys.call(path), call, SkillResult, timeout_s=self._settings.timeout_s + _GRACE_S
            )
        except AosError as error:
            _log.warning("%s failed: %s", path, error)
            raise
        return dict(result.fields)


if __name__ == "__main__":
    run_service(ServerSettings, serve)
