from typing import Any

import pytest
from msgspec.structs import replace
from places import DEPLOY

from aos_skills.pybullet.parts.room_file import Place
from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.cleanlab import KIND
from aos_skills.pybullet.worlds.cleanlab.file import CleanLabFile, FaultModel
from aos_skills.pybullet.worlds.cleanlab.world import CleanLab, filled_stations, place_of_cup

pytestmark = pytest.mark.physics


@pytest.fixture
def file() -> CleanLabFile:
    """The shipped laboratory, without faults."""
    room: CleanLabFile = load_world_file(DEPLOY / "worlds/cleanlab.yaml").room
    return replace(room, faults=FaultModel())


def call(world: CleanLab, path: str, fields: dict[str, Any] | None = None) -> dict[str, Any]:
    world.begin()
    answer = KIND.skills[path](world, fields or {})
    world.stop()
    return answer


def go(world: CleanLab, place: Place):
    assert call(world, "/navigate", {"x": place.x, "y": place.y, "yaw": place.yaw})["success"]


def at_station(file: CleanLabFile, name: str) -> CleanLabFile:
    return replace(file, robot=file.stations[name])


def test_a_cup_is_seen_picked_and_taken_to_a_bin(file: CleanLabFile):
    name = filled_stations(file, 1)[0]
    world = CleanLab(at_station(file, name), 1)
    assert call(world, "/look") == {"is_there": True}
    call(world, "/pick")
    assert world.held_cup == name
    assert world.sensors()["/gripper"]["gap_m"] > 0.01
    go(world, file.bins["left"])
    assert world.held_cup == name
    call(world, "/release")
    assert world.held_cup is None
    assert world.binned() == [name]


def test_a_cup_is_seen_where_it_stands_and_not_where_it_stood(file: CleanLabFile):
    name = filled_stations(file, 1)[0]
    world = CleanLab(at_station(file, name), 1)
    cup = world.cups[name]
    for dx, dy in ((0.0, 0.0), (0.05, -0.03), (-0.04, 0.04)):
        x, y, z = world.scene.place(cup)
        moved = (x + dx, y + dy, z)
        world.scene.client.resetBasePositionAndOrientation(cup, moved, (0, 0, 0, 1))
        assert place_of_cup(world) == pytest.approx(moved[:2], abs=0.003)


def test_what_is_not_seen_is_not_grasped(file: CleanLabFile):
    """A cup that is white to the camera, in the place where one would stand beside it."""
    name = filled_stations(file, 1)[0]
    world = CleanLab(at_station(file, name), 1)
    x, y, z = world.scene.place(world.cups[name])
    world.scene.client.changeVisualShape(world.cups[name], -1, rgbaColor=(1, 1, 1, 1))
    world.scene.client.resetBasePositionAndOrientation(world.cups[name], (x + 0.1, y, z), (0, 0, 0, 1))
    assert place_of_cup(world) is None
    call(world, "/pick")
    assert world.held_cup is None


def test_at_an_empty_station_nothing_is_seen_and_nothing_picked(file: CleanLabFile):
    empty = next(name for name in file.stations if name not in filled_stations(file, 1))
    world = CleanLab(at_station(file, empty), 1)
    assert call(world, "/look") == {"is_there": False}
    call(world, "/pick")
    assert world.held_cup is None
    assert world.sensors()["/gripper"]["gap_m"] < 0.01


def test_glare_hides_a_cup_and_a_ghost_shows_one(file: CleanLabFile):
    faulty = replace(file, faults=FaultModel(glare=1.0, ghost=1.0))
    name = filled_stations(file, 1)[0]
    empty = next(station for station in file.stations if station not in filled_stations(file, 1))
    assert call(CleanLab(at_station(faulty, name), 1), "/look") == {"is_there": False}
    assert call(CleanLab(at_station(faulty, empty), 1), "/look") == {"is_there": True}


def test_cups_stand_on_different_stations_of_each_side(file: CleanLabFile):
    drawn = {tuple(sorted(filled_stations(file, seed))) for seed in range(20)}
    assert len(drawn) > 5
    for names in drawn:
        assert len([name for name in names if name in ("s1", "s2", "s3")]) == 2
        assert len(names) == 4
