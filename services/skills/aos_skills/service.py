"""The skills service: answers calls of bound activation paths with adapters, and publishes their topics."""

from __future__ import annotations

import asyncio
import difflib
import logging
from collections import Counter
from pathlib import Path
from typing import Any

from aos_protocol.errors import DeployError, SkillError
from aos_protocol.messages import Cancel, Cancelled, SkillCall, SkillResult, TopicMessage
from aos_runtime.lifecycle import Service
from aos_skills.adapter import Adapter
from aos_skills.ledger import Ledger
from aos_skills.settings import Settings

__all__ = ["ADAPTERS", "serve"]

log = logging.getLogger(__name__)

ADAPTERS = ("pybullet",)


async def serve(service: Service[Settings]) -> None:
    """Serve until stopped; then stop whatever moves."""
    host = _Host(service)
    try:
        await host.run()
    finally:
        await host.close()


class _Host:
    """One robot: one call at a time, whichever adapter runs it."""

    def __init__(self, service: Service[Settings]) -> None:
        self._service = service
        self._loop = asyncio.get_running_loop()
        self._ledger = Ledger(Path(service.settings.run_dir) / "skills.db")
        self._published: Counter[str] = Counter()
        self._adapters: dict[str, Adapter] = {}
        self._running: SkillCall | None = None

    async def run(self) -> None:
        service = self._service
        for path, name in service.settings.bind.items():
            if name not in self._adapters:
                self._adapters[name] = self._adapter(name)
            if path not in self._adapters[name].paths:
                known = ", ".join(sorted(self._adapters[name].paths))
                raise DeployError(f"the adapter {name} has no skill at {path}", hint=f"It has {known}")
            await service.bus.answer(service.keys.call(path), SkillCall, self._call)
        await service.bus.answer(service.keys.cancel, Cancel, self._cancel)
        await service.ready()
        # A world takes a second to build, and the first decision has not been taken yet.
        for adapter in self._adapters.values():
            await adapter.prepare()
        await asyncio.Event().wait()

    async def close(self) -> None:
        for adapter in self._adapters.values():
            await adapter.close()
        self._ledger.close()

    def _adapter(self, name: str) -> Adapter:
        settings = self._service.settings
        if name not in ADAPTERS:
            near = difflib.get_close_matches(name, ADAPTERS, 1)
            hint = f"Did you mean {near[0]}?" if near else f"Known are {', '.join(ADAPTERS)}"
            raise DeployError(f"`bind:` names an unknown adapter, {name}", hint=hint)
        if not settings.world:
            raise DeployError("the adapter pybullet needs a world file", hint="Name it under `world:`")
        # Imported late: a robot without simulation needs no pybullet.
        from aos_skills.pybullet.adapter import PybulletAdapter
        from aos_skills.pybullet.world_file import load_world_file

        world = load_world_file(Path(settings.world))
        return PybulletAdapter(world, Path(settings.run_dir), settings.seed, self._publish)

    async def _call(self, call: SkillCall, _: str) -> SkillResult:
        stored = self._ledger.stored(call.id)
        if stored is not None:
            return stored
        if self._running is not None:
            raise SkillError(
                f"{call.path} is refused: {self._running.path} is running",
                code="AOS502",
                hint="One skill runs at a time",
            )
        path = "/" + call.path.strip("/")
        adapter = self._adapters[self._service.settings.bind[path]]
        self._running = call
        self._ledger.start(call)
        try:
            fields = await adapter.call(call.id, path, call.fields, call.deadline_s)
        finally:
            self._running = None
        # What the world's thread published has reached the loop before its answer did.
        result = SkillResult(call.id, fields, dict(self._published))
        self._ledger.end(result)
        return result

    async def _cancel(self, cancel: Cancel, _: str) -> Cancelled:
        running = self._running
        if running is None:
            return Cancelled()
        log.info("cancelling %s: %s", running.path, cancel.reason)
        for adapter in self._adapters.values():
            adapter.cancel()
        return Cancelled((str(running.id),))

    def _publish(self, topic: str, fields: dict[str, Any]) -> None:
        """From an adapter's thread to the bus, in order."""
        self._loop.call_soon_threadsafe(self._tell, topic, fields)

    def _tell(self, topic: str, fields: dict[str, Any]) -> None:
        self._published[topic] += 1
        message = TopicMessage(self._published[topic], fields)
        self._service.bus.tell(self._service.keys.topic(topic), message)
