"""Navigate: plan a way on the map, follow it, and plan again around what the lidar sees and the map lacks."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.route import Following, Point, follow
from aos_skills.pybullet.worlds.turtlebot.world import Turtlebot

MAX_PLANS = 12
UNMAPPED_M = 0.12
"""A point of the lidar further than this from everything on the map is something new."""
LEAVE_M = 0.1
"""A way may begin too near to something, up to here: the robot stands there already, and has to leave."""


def navigate(world: Turtlebot, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes `x` and `y` in metres; `success` says whether it arrived.

    Where no way is left, the robot stays where it saw that.
    """
    goal = (float(fields["x"]), float(fields["y"]))
    if not _arrives(world, goal):
        return {"success": False}
    return {"success": not world.faults.draw("the report is lost", world.file.faults.lost_report)}


def _arrives(world: Turtlebot, goal: Point) -> bool:
    robot, floor_map = world.robot, world.floor_map
    floor_map.forget()
    gathered: npt.NDArray[np.float64] = np.empty((0, 2))
    looked_s = -1.0

    def is_free(way_ahead: list[Point]) -> bool:
        nonlocal gathered, looked_s
        if world.scene.time_s - looked_s < 0.2:
            return True
        looked_s = world.scene.time_s
        points = robot.seen_points()
        new = points[floor_map.distance(points) > UNMAPPED_M]
        # Cells hold one point each, so that standing still does not gather thousands.
        gathered = np.unique(np.round(np.concatenate([gathered, new]) / 0.03) * 0.03, axis=0)
        if len(new) == 0:
            return True
        floor_map.add(np.unique(np.round(new / 0.03) * 0.03, axis=0))
        ahead = [point for point in way_ahead if math.dist(point, robot.place[:2]) > LEAVE_M]
        return not ahead or floor_map.is_free(np.array(ahead))

    for _ in range(MAX_PLANS):
        way = floor_map.way(robot.place[:2], goal)
        if way is None:
            return False
        if follow(world.scene, robot.drive, way, is_free) is Following.ARRIVED:
            return True
    return False
