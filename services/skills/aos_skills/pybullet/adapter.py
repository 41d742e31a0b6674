"""The simulated Armadillo as an adapter: its world runs on a thread of its own, beside the service."""

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
from aos_skills.pybullet.camera import Camera
from aos_skills.pybullet.robot import Robot
from aos_skills.pybullet.scene import STEP_S, Scene
from aos_skills.pybullet.skills import SKILL_PATHS, ArmadilloSkills
from aos_skills.pybullet.world_file import WorldFile

__all__ = ["PybulletAdapter"]

PUBLISH_EVERY_S = 0.05


class PybulletAdapter:
    """Everything of pybullet happens on one thread, first of all the building of the world."""

    paths = SKILL_PATHS

    def __init__(self, world: WorldFile, run_dir: Path, seed: int, publish: Publish) -> None:
        self._run_dir = run_dir
        self._publish = publish
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="world")
        self._is_cancelled = threading.Event()
        self._deadline_s = float("inf")
        self._next_publication_s = 0.0
        self._skills: ArmadilloSkills
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
        self._scene = Scene(world)
        self._robot = Robot(self._scene, lambda: None)
        self._camera = Camera(self._scene, self._robot)
        self._skills = ArmadilloSkills(self._scene, self._robot, seed)
        self._robot.on_tick = self._tick

    def _run(self, id: ActivationId, path: str, fields: dict[str, Any]) -> dict[str, Any]:
        try:
            answer = self._skills.call(path, fields)
        except (KeyError, TypeError, ValueError) as error:
            raise SkillError(
                f"{path} cannot use the fields {fields}: {error!r}",
                code="AOS502",
                hint="Look at the parameters that the abstraction mapping assigns",
            ) from error
        finally:
            self._robot.stop()
            self._record(id, path)
        self._publish_sensors()
        self._camera.save_picture(self._run_dir / "pictures" / f"step-{id.step:03d}.png")
        return answer

    def _tick(self) -> None:
        """After every simulation step."""
        if self._is_cancelled.is_set():
            raise SkillError("the skill was cancelled", code="AOS507")
        if time.monotonic() > self._deadline_s:
            raise SkillError("the skill took longer than it may", code="AOS503")
        self._skills.watch_person()
        self._camera.watch()
        if self._scene.time_s >= self._next_publication_s:
            self._next_publication_s = self._scene.time_s + PUBLISH_EVERY_S - STEP_S / 2
            self._publish_sensors()

    def _publish_sensors(self) -> None:
        left, right = (0.0, 0.0) if self._skills.is_silent else self._robot.finger_forces_n()
        self._publish("/gripper", {"gap_m": self._robot.gap_m, "left_force_n": left, "right_force_n": right})
        self._publish("/joints", {"positions": self._robot.arm_angles})

    def _record(self, id: ActivationId, path: str) -> None:
        """The truth about the world, for reports; the robot is not told."""
        scene = self._scene
        truth = {
            "step": id.step,
            "path": path,
            "time_s": round(scene.time_s, 3),
            "base": [round(value, 3) for value in self._robot.base_place],
            "cans": {name: [round(value, 3) for value in scene.can_place(name)] for name in scene.cans},
            "is_holding": self._skills.is_holding,
            "is_delivered": any(scene.is_on_tray(name) for name in scene.cans),
            "has_injured": self._skills.has_injured,
            "drawn_faults": list(self._skills.drawn),
        }
        with (self._run_dir / "world.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps(truth) + "\n")

    def _finish(self) -> None:
        self._camera.save_animation(self._run_dir / "mission.gif")
        self._scene.close()
