from collections.abc import Callable
from typing import Any

import pytest
from msgspec.structs import replace
from places import DEPLOY

from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.armadillo import KIND
from aos_skills.pybullet.worlds.armadillo.file import ArmadilloFile, FaultModel
from aos_skills.pybullet.worlds.armadillo.skills import STRETCHED, _perceived, can_in_reach
from aos_skills.pybullet.worlds.armadillo.world import Armadillo

pytestmark = pytest.mark.physics

EASY_TABLE = {"x": 0.0, "y": 2.0, "yaw": 1.5708}
CORRIDOR = {"x": 4.0, "y": 0.0, "yaw": 0.0}

Make = Callable[..., Armadillo]


@pytest.fixture
def file() -> ArmadilloFile:
    room: ArmadilloFile = load_world_file(DEPLOY / "worlds/armadillo.yaml").room
    return room


@pytest.fixture
def make(file: ArmadilloFile) -> Make:
    """A robot in a fresh room with a fault model of the test's choice."""

    def build(faults: FaultModel, seed: int = 1) -> Armadillo:
        return Armadillo(replace(file, faults=faults), seed)

    return build


def call(world: Armadillo, path: str, fields: dict[str, Any] | None = None) -> dict[str, Any]:
    world.begin()
    return KIND.skills[path](world, fields or {})


def with_misplaced_easy_can(file: ArmadilloFile, probability: float) -> ArmadilloFile:
    easy = file.tables["easy"]
    can = replace(easy.can, misplaced=probability)
    tables = {**file.tables, "easy": replace(easy, can=can)}
    return replace(file, tables=tables, faults=FaultModel())


def test_a_faultless_robot_brings_the_easy_can_to_the_person(make: Make):
    world = make(FaultModel())
    assert call(world, "/navigate", EASY_TABLE)["success"]
    assert call(world, "/pick")["success"]
    assert world.is_holding
    assert call(world, "/navigate", CORRIDOR)["success"]
    assert world.is_holding
    assert call(world, "/serve")["success"]
    assert world.room.is_on_tray("easy")
    assert not world.has_injured


def test_the_hard_can_is_not_grasped_where_the_robot_sees_it(make: Make):
    world = make(FaultModel())
    assert call(world, "/pick")["success"]
    assert not world.is_holding
    left, right = world.robot.gripper.forces_n()
    assert world.robot.gripper.gap_m < 0.005 or min(left, right) == 0


def test_a_lost_can_is_not_picked_again(make: Make, file: ArmadilloFile):
    world = make(file.faults, seed=3)
    call(world, "/pick")
    world.scene.wait(1.0)
    assert not world.is_holding
    assert can_in_reach(world) is None
    call(world, "/pick")
    assert not world.is_holding


def test_a_misplaced_can_stays_and_may_be_picked_again(make: Make, file: ArmadilloFile):
    world = make(FaultModel())
    before = world.room.can_place("easy")
    call(world, "/navigate", EASY_TABLE)
    world.file = with_misplaced_easy_can(file, 1.0)
    call(world, "/pick")
    assert not world.is_holding
    assert world.room.can_place("easy") == pytest.approx(before, abs=1e-3)
    world.file = with_misplaced_easy_can(file, 0.0)
    call(world, "/pick")
    assert world.is_holding


def test_an_arm_that_stays_out_is_reported_and_hurts_whoever_is_served(make: Make):
    world = make(FaultModel(arm_stays_out=1.0))
    call(world, "/navigate", EASY_TABLE)
    assert not call(world, "/pick")["success"]
    assert world.robot.arm.angles[3] > -2.3
    call(world, "/navigate", CORRIDOR)
    call(world, "/serve")
    assert world.has_injured


@pytest.mark.parametrize("table", ["easy", "hard"])
def test_a_can_is_grasped_where_it_is_seen(make: Make, table):
    world = make(FaultModel())
    if table == "easy":
        call(world, "/navigate", EASY_TABLE)
    can = world.room.cans[table]
    x, y, z = world.room.can_place(table)
    for dx, dy in ((0.0, 0.0), (0.04, -0.03), (-0.03, 0.02)):
        world.scene.client.resetBasePositionAndOrientation(can, (x + dx, y + dy, z), (0, 0, 0, 1))
        place = _perceived(world, table)
        assert place[:2] == pytest.approx((x + dx, y + dy), abs=0.001)
    world.scene.client.changeVisualShape(can, -1, rgbaColor=(1, 1, 1, 1))
    assert _perceived(world, table) is None


def test_the_arm_comes_back_where_the_fingers_feel_nothing(make: Make):
    world = make(FaultModel(arm_stays_out=1.0))
    assert call(world, "/pick")["success"]
    assert not world.is_holding
    assert world.truth()["state"]["robot_at"] == "HardTable"


def test_an_arm_that_stayed_out_is_folded_with_the_can_in_the_hand(make: Make):
    world = make(FaultModel(arm_stays_out=1.0))
    call(world, "/navigate", EASY_TABLE)
    assert not call(world, "/pick")["success"]
    assert call(world, "/retract")["success"]
    assert world.robot.arm.angles[3] < -2.3
    assert world.is_holding


def test_an_arm_may_stay_out_again(make: Make):
    world = make(FaultModel(arm_stays_out_again=1.0))
    assert call(world, "/retract")["success"]  # It was folded all the time.
    world.robot.arm.move(STRETCHED)
    assert not call(world, "/retract")["success"]
    assert world.robot.arm.angles[3] > -2.3


def test_the_same_seed_gives_the_same_world(make: Make, file: ArmadilloFile):
    ends = []
    for _ in range(2):
        world = make(file.faults, seed=3)
        call(world, "/pick")
        ends.append((world.robot.arm.angles, world.room.can_place("hard")))
    assert ends[0] == ends[1]
