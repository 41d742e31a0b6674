"""A simulated world as an adapter: it runs on a thread of its own, beside the service."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from aos_protocol.errors import SkillError
from aos_protocol.messages import ActivationId
from aos_skills.adapter import Publish
from aos_skills.pybullet.parts.scene import STEP_S
from aos_skills.pybullet.parts.world import World
from aos_skills.pybullet.world_file import WorldFile

__all__ = ["PybulletAdapter"]

PUBLISH_EVERY_S = 0.05


class PybulletAdapter:
    """Everything of pybullet happens on one thread, first of all the building of the world."""

    def __init__(self, world: WorldFile, run_dir: Path, seed: int, publish: Publish) -> None:
        self.paths = frozenset(world.kind.skills)
        self._skills = world.kind.skills
        self._run_dir = run_dir
        self._publish = publish
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="world")
        self._is_cancelled = threading.Event()
        self._deadline_s = float("inf")
        self._next_publication_s = 0.0
        self._world: World
        self._building = self._thread.submit(self._build, world, seed)

    async def prepare(self) -> None:
        await asyncio.wrap_future(self._building)

    async def call(
        self, id: ActivationId, path: str, fields: dict[str, Any], deadline_s: float
    ) -> dict[str, Any]:
        self._is_cancelled.clear()
        self._deadline_s = time.monotonic() + deadline_s
        answer: dict[str, Any] = await self._on_thread(self._run, id, path, fields)
        return answer

    def cancel(self) -> None:
        self._is_cancelled.set()

    async def close(self) -> None:
        """Stops what moves and leaves the animated picture of the mission."""
        self.cancel()
        await asyncio.wait([asyncio.wrap_future(self._building)])
        if self._building.exception() is None:
            await self._on_thread(self._finish)
        self._thread.shutdown()

    async def _on_thread(self, work: Any, *arguments: Any) -> Any:
        return await asyncio.get_running_loop().run_in_executor(self._thread, work, *arguments)

    # --- on the world's thread -----------------------------------------------------------------------

    def _build(self, world: WorldFile, seed: int) -> None:
        self._world = world.build(seed)
        self._world.scene.watchers += [self._look_for_an_end, self._world.camera.watch, self._publish_in_time]

    def _run(self, id: ActivationId, path: str, fields: dict[str, Any]) -> dict[str, Any]:
        try:
            self._world.begin()
            answer = self._skills[path](self._world, fields)
        except (KeyError, TypeError, ValueError) as error:
            raise SkillError(
                f"{path} cannot use the fields {fields}: {error!r}",
                code="AOS502",
                hint="Look at the parameters that the abstraction mapping assigns",
            ) from error
        finally:
            self._world.stop()
            self._record(id, path)
        self._publish_sensors()
        self._world.camera.save_picture(self._run_dir / "pictures" / f"step-{id.step:03d}.png")
        return answer

    def _look_for_an_end(self) -> None:
        """After every simulation step."""
        if self._is_cancelled.is_set():
            raise SkillError("the skill was cancelled", code="AOS507")
        if time.monotonic() > self._deadline_s:
            raise SkillError("the skill took longer than it may", code="AOS503")

    def _publish_in_time(self) -> None:
        if self._world.scene.time_s >= self._next_publication_s:
            self._next_publication_s = self._world.scene.time_s + PUBLISH_EVERY_S - STEP_S / 2
            self._publish_sensors()

    def _publish_sensors(self) -> None:
        for topic, fields in self._world.sensors().items():
            self._publish(topic, fields)

    def _record(self, id: ActivationId, path: str) -> None:
        """The truth about the world, for reports; the robot is not told."""
        truth = {
            "step": id.step,
            "path": path,
            "time_s": round(self._world.scene.time_s, 3),
            **self._world.truth(),
            "drawn_faults": list(self._world.faults.drawn),
        }
        with (self._run_dir / "world.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps(truth) + "\n")

    def _finish(self) -> None:
        self._world.camera.save_animation(self._run_dir / "mission.gif")
        self._world.scene.close()
