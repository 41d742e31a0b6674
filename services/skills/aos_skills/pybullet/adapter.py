"""A simulated world as an adapter: it runs on a thread of its own, beside the service."""

import asyncio
import json
import time
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from aos_protocol.errors import DeployError, SkillError
from aos_runtime.adapters import Call, Host
from aos_skills.pybullet.parts.scene import STEP_S
from aos_skills.pybullet.parts.world import World
from aos_skills.pybullet.world_file import WorldFile, load_world_file

PUBLISH_EVERY_S = 0.05


class PybulletAdapter:
    """Everything of pybullet happens on one thread, first of all the building of the world."""

    version = "1"

    def __init__(self, host: Host) -> None:
        self._host = host
        self._run_dir = host.run_dir
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="world")
        self._next_publication_s = 0.0
        self._call: Call | None = None
        self._skills: Mapping[str, Any] = {}
        self._world: World
        self._has_pictures = True
        self._building: Future[None] | None = None

    async def start(self) -> None:
        """Builds the world, which takes a second. `options` name its file under `world`."""
        named = self._host.options.get("world")
        if not named:
            raise DeployError("the adapter pybullet needs a world file", hint="Name it under `world:`")
        world = load_world_file(self._host.folder / named)
        self._skills = world.kind.skills
        paths = self._host.chosen(self._skills)
        self._building = self._thread.submit(self._build, world, self._host.seed)
        await asyncio.wrap_future(self._building)
        await self._host.serve(*paths)

    async def call(self, call: Call) -> dict[str, Any]:
        """The thread looks at every simulation step whether it has to stop."""
        self._call = call
        running = asyncio.ensure_future(self._on_thread(self._run, call))
        try:
            answer: dict[str, Any] = await asyncio.shield(running)
        except asyncio.CancelledError:
            await asyncio.wait({running})
            raise
        return answer

    async def close(self) -> None:
        """Leaves the animated picture of the mission."""
        if self._building is not None:
            await asyncio.wait([asyncio.wrap_future(self._building)])
            if self._building.exception() is None:
                await self._on_thread(self._finish)
        self._thread.shutdown()

    async def _on_thread(self, work: Any, *arguments: Any) -> Any:
        return await asyncio.get_running_loop().run_in_executor(self._thread, work, *arguments)

    # --- on the world's thread ---

    def _build(self, world: WorldFile, seed: int) -> None:
        self._world = world.build(seed)
        self._has_pictures = world.room.pictures
        self._world.scene.watchers += [self._look_for_an_end, self._publish_in_time]
        if self._has_pictures:
            self._world.scene.watchers.append(self._world.camera.watch)

    def _run(self, call: Call) -> dict[str, Any]:
        begun_s = time.thread_time()
        try:
            self._world.begin()
            answer: dict[str, Any] = self._skills[call.target](self._world, call.fields)
        except (KeyError, TypeError, ValueError) as error:
            raise SkillError(
                f"{call.target} cannot use the fields {call.fields}: {error!r}",
                hint="Look at the parameters that the abstraction mapping assigns",
            ) from error
        finally:
            self._world.stop()
            self._record(call, time.thread_time() - begun_s)
        self._publish_sensors()
        if self._has_pictures:
            self._world.camera.save_picture(self._run_dir / "pictures" / f"step-{call.id.step:03d}.png")
        return answer

    def _look_for_an_end(self) -> None:
        """Raises if the call was cancelled; it is called after every simulation step."""
        if self._call is not None and self._call.is_cancelled:
            raise SkillError("the skill was cancelled", code="AOS507")

    def _publish_in_time(self) -> None:
        if self._world.scene.time_s >= self._next_publication_s:
            self._next_publication_s = self._world.scene.time_s + PUBLISH_EVERY_S - STEP_S / 2
            self._publish_sensors()

    def _publish_sensors(self) -> None:
        for topic, fields in self._world.sensors().items():
            self._host.publish(topic, fields)

    def _record(self, call: Call, processor_s: float) -> None:
        """The truth about the world, and what its simulation took, for reports; the robot is not told."""
        truth = self._world.record(call.id.step, call.target, call.fields)
        truth["processor_s"] = round(processor_s, 3)
        with (self._run_dir / "world.jsonl").open("a", encoding="utf-8") as file:
            file.write(json.dumps(truth) + "\n")

    def _finish(self) -> None:
        self._world.camera.save_animation(self._run_dir / "mission.gif")
        self._world.close()
