"""The simulated Armadillo: what its skills do, in real physics."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from aos_skills.pybullet.robot import Robot
from aos_skills.pybullet.scene import Scene
from aos_skills.pybullet.skills import ArmadilloSkills
from aos_skills.pybullet.world_file import FaultModel, WorldFile, load_world_file

pytestmark = pytest.mark.physics

EASY_TABLE = {"x": 0.0, "y": 2.0, "yaw": 1.5708}
CORRIDOR = {"x": 4.0, "y": 0.0, "yaw": 0.0}

Make = Callable[..., ArmadilloSkills]


@pytest.fixture
def world(root: Path) -> WorldFile:
    return load_world_file(root / "deploy/worlds/armadillo.yaml")


@pytest.fixture
def make(world: WorldFile) -> Make:
    """A robot in a fresh room with a fault model of the test's choice."""

    def build(faults: FaultModel, seed: int = 1) -> ArmadilloSkills:
        scene = Scene(msgspec.structs.replace(world, faults=faults))
        robot = Robot(scene, lambda: None)
        skills = ArmadilloSkills(scene, robot, seed)
        robot.on_tick = skills.watch_person
        return skills

    return build


def with_misplaced_easy_can(world: WorldFile, probability: float) -> WorldFile:
    easy = world.tables["easy"]
    can = msgspec.structs.replace(easy.can, misplaced=probability)
    tables = {**world.tables, "easy": msgspec.structs.replace(easy, can=can)}
    return msgspec.structs.replace(world, tables=tables, faults=FaultModel())


def test_a_faultless_robot_brings_the_easy_can_to_the_person(make: Make) -> None:
    skills = make(FaultModel())
    assert skills.call("/navigate", EASY_TABLE)["success"]
    assert skills.call("/pick", {})["success"]
    assert skills.is_holding
    assert skills.call("/navigate", CORRIDOR)["success"]
    assert skills.is_holding
    assert skills.call("/serve", {})["success"]
    assert skills.scene.is_on_tray("easy")
    assert not skills.has_injured


def test_the_hard_can_is_not_grasped_where_the_robot_sees_it(make: Make) -> None:
    skills = make(FaultModel())
    assert skills.call("/pick", {})["success"]
    assert not skills.is_holding
    left, right = skills.robot.finger_forces_n()
    assert skills.robot.gap_m < 0.005 or min(left, right) == 0


def test_a_lost_can_is_not_picked_again(make: Make, world: WorldFile) -> None:
    skills = make(world.faults, seed=3)
    skills.call("/pick", {})
    skills.robot.wait(1.0)
    assert not skills.is_holding
    assert not skills.sees_can
    skills.call("/pick", {})
    assert not skills.is_holding


def test_a_misplaced_can_stays_and_may_be_picked_again(make: Make, world: WorldFile) -> None:
    skills = make(FaultModel())
    before = skills.scene.can_place("easy")
    skills.call("/navigate", EASY_TABLE)
    skills.scene.file = with_misplaced_easy_can(world, 1.0)
    skills.call("/pick", {})
    assert not skills.is_holding
    assert skills.scene.can_place("easy") == pytest.approx(before, abs=1e-3)
    skills.scene.file = with_misplaced_easy_can(world, 0.0)
    skills.call("/pick", {})
    assert skills.is_holding


def test_the_frequencies_are_json_and_nothing_else(root: Path) -> None:
    command = [sys.executable, "-m", "aos_skills.pybullet.frequencies", "deploy/worlds/armadillo.yaml"]
    ended = subprocess.run([*command, "1", "--json"], cwd=root, capture_output=True, timeout=120, check=True)
    counts = json.loads(ended.stdout)
    assert counts["picks"] == 1
    assert sum(counts["easy"].values()) == sum(counts["hard"].values()) == 1
    assert b"of 1 picks" in ended.stderr


def test_an_arm_that_stays_out_is_reported_and_hurts_whoever_is_served(make: Make) -> None:
    skills = make(FaultModel(arm_stays_out=1.0))
    skills.call("/navigate", EASY_TABLE)
    assert not skills.call("/pick", {})["success"]
    assert skills.robot.arm_angles[3] > -2.3
    skills.call("/navigate", CORRIDOR)
    skills.call("/serve", {})
    assert skills.has_injured


def test_the_same_seed_gives_the_same_world(make: Make, world: WorldFile) -> None:
    ends = []
    for _ in range(2):
        skills = make(world.faults, seed=3)
        skills.call("/pick", {})
        ends.append((skills.robot.arm_angles, skills.scene.can_place("hard")))
    assert ends[0] == ends[1]
