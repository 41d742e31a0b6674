import math
from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np
import pytest
from places import DEPLOY

from aos_skills.pybullet.parts.room_file import Place
from aos_skills.pybullet.parts.route import FloorMap
from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.turtlebot import KIND
from aos_skills.pybullet.worlds.turtlebot.file import Crate, FaultModel, TurtlebotFile
from aos_skills.pybullet.worlds.turtlebot.navigate import UNMAPPED_M
from aos_skills.pybullet.worlds.turtlebot.world import Turtlebot

pytestmark = pytest.mark.physics

Make = Callable[..., Turtlebot]


@pytest.fixture
def make() -> Make:
    file: TurtlebotFile = load_world_file(DEPLOY / "worlds/turtlebot.yaml").room

    def build(**changes: Any) -> Turtlebot:
        return Turtlebot(msgspec.structs.replace(file, **changes), seed=1)

    return build


def go(world: Turtlebot, x: float, y: float) -> bool:
    world.begin()
    answer = KIND.skills["/navigate"](world, {"x": x, "y": y})
    world.stop()
    return bool(answer["success"])


def test_it_drives_around_a_block_to_its_goal(make: Make):
    world = make()
    assert go(world, -1.6, -0.5)
    assert go(world, -1.5, 1.0)
    assert math.dist(world.robot.true_place[:2], (-1.5, 1.0)) < 0.08
    assert world.visits == ["l1", "l2"]
    straight = math.dist((-1.7, -1.7), (-1.6, -0.5)) + math.dist((-1.6, -0.5), (-1.5, 1.0))
    assert straight < world.way_m < straight + 0.4


def test_a_crate_on_no_map_is_seen_and_the_place_under_it_reported_as_failed(make: Make):
    world = make(crates={"l1": Crate(-1.6, -0.5)})
    assert not go(world, -1.6, -0.5)
    assert world.visits == []
    contacts = world.scene.client.getContactPoints(bodyA=world.robot.body)
    floor = 0
    assert {contact[2] for contact in contacts} == {floor}


def test_the_record_says_what_was_asked_and_which_places_were_missed(make: Make):
    places = {"l1": Place(-1.6, -0.5), "l2": Place(-1.5, 1.0), "l3": Place(-0.5, 1.6)}
    world = make(places=places, crates={"l3": Crate(-0.5, 1.6)})
    assert go(world, -1.6, -0.5)
    record = world.record(1, "/navigate", {"x": -1.6, "y": -0.5})
    assert record["fields"] == {"x": -1.6, "y": -0.5}
    assert record["missed"] == ["l2"]
    assert record["stood"] == {"l1": 1}
    assert record["repeated"] == []


def test_a_crate_in_the_way_is_gone_around(make: Make):
    world = make(crates={"in the way": Crate(-1.68, -1.1, half=0.1)})
    assert go(world, -1.6, -0.5)
    assert world.visits == ["l1"]


def test_from_beside_a_crate_it_drives_away(make: Make):
    world = make(crates={"beside": Crate(-1.44, -1.7)})
    assert go(world, -1.6, -0.5)
    assert world.visits == ["l1"]


def test_while_it_turns_it_sees_nothing_but_what_is_on_the_map(make: Make):
    """Whoever else reads the lidar, too."""
    world = make()
    world.robot.drive.command(0.0, 2.0)
    world.scene.wait(1.0)
    for _ in range(20):
        world.sensors()
        world.scene.wait(0.05)
        assert world.floor_map.distance(world.robot.seen_points()).max() < UNMAPPED_M


def test_a_lost_report_says_failed_where_the_robot_arrived(make: Make):
    world = make(faults=FaultModel(lost_report=1.0))
    assert not go(world, -1.65, -1.5)
    assert math.dist(world.robot.true_place[:2], (-1.65, -1.5)) < 0.08


def test_the_lidar_measures_the_walls(make: Make):
    world = make(obstacles=[])
    ranges = world.robot.ranges_m()
    x, y, yaw = world.robot.true_place
    assert yaw == pytest.approx(math.pi / 2, abs=0.01)
    lidar_y = y - 0.032
    ahead, left, behind = ranges[0], ranges[30], ranges[60]
    assert ahead == pytest.approx(3.5)
    assert left == pytest.approx(2.0 + x, abs=0.02)
    assert behind == pytest.approx(2.0 + lidar_y, abs=0.02)


def test_a_place_that_no_way_leads_to_has_none():
    wall = (0.0, 0.0, 0.1, 2.0)
    floor_map = FloorMap((0.0, 0.0, 2.0, 2.0), [wall], 0.14)
    assert floor_map.way((-1.0, 0.0), (1.0, 0.0)) is None
    assert floor_map.way((-1.0, 0.0), (0.0, 0.0)) is None
    way = floor_map.way((-1.0, -1.0), (-1.0, 1.0))
    assert way[0] == (-1.0, -1.0)
    assert way[-1] == (-1.0, 1.0)
    assert floor_map.is_free(np.array(way))


def test_the_same_seed_drives_the_same_way(make: Make):
    noisy = FaultModel(place_noise_m=0.01, yaw_noise_rad=0.01)
    places = []
    for _ in range(2):
        world = make(faults=noisy)
        assert go(world, -1.6, -1.2)
        places.append(world.robot.true_place)
    assert places[0] == places[1]
