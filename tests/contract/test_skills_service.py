import asyncio
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from adapter_process import AdapterProcess
from deploy_files import world_without_pictures
from places import DEPLOY
from processes import HANG_S
from starting import until_present

from aos_protocol.keys import Keys
from aos_protocol.messages import (
    ActivationId,
    MissionQuery,
    MissionState,
    SkillCall,
    SkillResult,
    TopicMessage,
)
from aos_runtime.adapters import Binding
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import Child

pytestmark = pytest.mark.physics

ALL_PATHS = {path: Binding() for path in ("/navigate", "/pick", "/sense", "/serve")}
FAR_AWAY = {"x": 4.0, "y": 0.0, "yaw": 0.0}


class Robot(AdapterProcess):
    def __init__(self, bus: Bus, keys: Keys, endpoint: str, folder: Path, world: Path):
        super().__init__(bus, keys, endpoint, folder)
        self.world = world

    async def launch(self, **settings: Any) -> Child:
        shipped = {"bind": ALL_PATHS, "options": {"world": str(self.world)}}
        adapter = "aos_skills.pybullet.adapter:PybulletAdapter"
        return await self.launched("pybullet", adapter=adapter, **(shipped | settings))

    async def start(self):
        """Starts the process; returns when it answers."""
        async with until_present(self.bus, self.keys.live("pybullet")):
            await self.launch()

    async def call(
        self,
        path: str,
        step: int = 1,
        fields: dict[str, Any] | None = None,
        *,
        epoch: int = 1,
        limit_s: float = 60.0,
    ) -> SkillResult:
        return await self.ask(SkillCall(ActivationId("m", step), path, fields or {}, limit_s, epoch=epoch))

    async def moving(self):
        """Returns when simulated time passes: the sensors publish while a skill runs."""
        async with (
            asyncio.timeout(HANG_S),
            self.bus.listen(self.keys.topic("/joints"), TopicMessage) as joints,
        ):
            async for _ in joints:
                return


@pytest_asyncio.fixture
async def robot(bus: Bus, keys: Keys, endpoint: str, tmp_path) -> AsyncIterator[Robot]:
    """A robot that is not started yet; whatever a test starts is stopped."""
    (tmp_path / "pictures").mkdir()
    robot = Robot(bus, keys, endpoint, tmp_path, world_without_pictures(tmp_path))
    try:
        yield robot
    finally:
        await robot.stop()


async def test_a_call_is_answered_refused_with_a_hint_or_stopped_when_it_takes_too_long(robot: Robot):
    robot.world = DEPLOY / "worlds/armadillo.yaml"
    await robot.start()
    async with robot.bus.listen(robot.keys.topic("/gripper"), TopicMessage) as gripper:
        result = await robot.call("/sense")
        messages = [message async for _, message in _first(gripper, result.published["/gripper"])]
    assert set(result.fields) == {"gap_m", "left_force_n", "right_force_n", "positions"}
    assert [message.number for message in messages] == list(range(1, len(messages) + 1))
    assert set(messages[-1].fields) == {"gap_m", "left_force_n", "right_force_n"}
    assert result.published["/joints"] == result.published["/gripper"]
    refused = await robot.refusal("/navigate", 2, {"x": "far"})
    assert refused.code == "AOS502"
    assert "abstraction mapping" in str(refused)
    assert (await robot.refusal("/navigate", 3, FAR_AWAY, limit_s=0.01)).code == "AOS503"
    assert "gap_m" in (await robot.call("/sense", 4)).fields
    # A stopped world leaves the animated picture of its mission.
    await robot.stop()
    assert (robot.folder / "mission.gif").stat().st_size > 0
    assert (robot.folder / "pictures" / "step-001.png").stat().st_size > 0


async def test_one_skill_runs_at_a_time_until_it_is_cancelled(robot: Robot):
    await robot.start()
    driving = asyncio.create_task(robot.refusal("/navigate", 1, FAR_AWAY))
    await robot.moving()
    refused = await robot.refusal("/pick", 2)
    assert refused.code == "AOS502"
    assert "/navigate is running" in str(refused)
    assert (await robot.cancel("/pick")).ids == ("m-1",)
    assert (await driving).code == "AOS507"
    # It can move again, and what was refused never ran.
    assert "gap_m" in (await robot.call("/sense", 3)).fields
    assert "gap_m" in (await robot.call("/sense", 2)).fields
    # This world's file asks for no pictures.
    await robot.stop()
    assert not (robot.folder / "mission.gif").exists()
    assert not any((robot.folder / "pictures").iterdir())


async def test_a_repeated_activation_moves_nothing_and_an_older_epoch_is_refused(robot: Robot):
    await robot.start()
    assert (await robot.refusal("/sense", 1, epoch=2)).code == "AOS506"

    async def state(_: MissionQuery, __: str) -> MissionState:
        return MissionState("m", "acting", 1, 0.0, epoch=2)

    await robot.bus.answer(robot.keys.mission_state, MissionQuery, state)
    first = await robot.call("/sense", 1, epoch=2)
    assert await robot.call("/sense", 1, epoch=2) == first
    assert (await robot.refusal("/sense", 2, epoch=1)).code == "AOS506"


async def test_after_a_crash_in_motion_the_outcome_is_unknown_and_nothing_moves(robot: Robot):
    await robot.start()
    assert "gap_m" in (await robot.call("/sense", 1)).fields
    driving = asyncio.create_task(robot.refusal("/navigate", 2, FAR_AWAY))
    await robot.moving()
    assert robot.child is not None
    robot.child.kill()
    await driving
    await robot.child.wait()
    await robot.start()
    assert (await robot.refusal("/navigate", 2, FAR_AWAY)).code == "AOS504"
    assert (await robot.call("/sense", 1)).published  # What ended before is answered from the ledger.


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"bind": {"/dance": Binding()}}, "the adapter pybullet has no skill at /dance"),
        ({"options": {}}, "the adapter pybullet needs a world file"),
        ({"options": {"world": "nowhere.yaml"}}, "nowhere.yaml: cannot be read"),
    ],
)
async def test_what_cannot_be_bound_ends_the_service_with_one_message(
    robot: Robot, settings: dict[str, Any], message
):
    child = await robot.launch(**settings)
    async with asyncio.timeout(HANG_S):
        assert await child.wait() == 1
    assert message in (robot.folder / "pybullet.log").read_text()


async def _first(messages: Any, count: int) -> AsyncIterator[Any]:
    async with asyncio.timeout(HANG_S):
        for _ in range(count):
            yield await anext(aiter(messages))
