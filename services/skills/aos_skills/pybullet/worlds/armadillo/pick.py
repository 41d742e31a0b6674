"""Pick: reach for the can on the table where the robot stands, close the fingers, lift, fold the arm."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.parts.boom_camera import Colors, top_seen
from aos_skills.pybullet.robots.mobile_arm.grasp import SHOULDER_AHEAD_M, grasp_from_above
from aos_skills.pybullet.worlds.armadillo.room import TABLE_TOP_M
from aos_skills.pybullet.worlds.armadillo.world import Armadillo

STRETCHED = (0.0, 0.75, 0.0, -0.75, 0.0, 1.5, 0.785)
"""Arm joint angles in radians of an arm that did not return."""
REACH_M = 0.8
LOWEST_GRASP_M = 0.008
"""Lower, the finger tips stand on the table and do not close."""
GRASP_ABOVE_CENTRE_M = 0.006
"""A thing that is grasped this much above its centre hangs, and does not turn over."""
GRASPABLE_RADII_M = (0.02, 0.038)
"""A thing that looks larger does not fit between the fingers; one that looks smaller is no can."""
MISPLACED_BY_M = 0.08
LIFT_M = 0.22


def pick(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing. `success` is false if the arm stays out; a missed or dropped can is not noticed."""
    robot = world.robot
    robot.gripper.open()
    robot.arm.move(TUCKED)
    can = can_in_reach(world)
    perceived = _perceived(world, can) if can is not None else None
    if perceived is None:
        return {"success": True}
    x, y, height = perceived
    above = TABLE_TOP_M + LIFT_M
    grasp = TABLE_TOP_M + max(height, LOWEST_GRASP_M)
    grasp_from_above(robot, (x, y, grasp), above)
    # What is between the fingers has to be led past the table; without it there is always a way.
    if robot.gripper.feels_something and world.faults.draw(
        "the arm stays out", world.file.faults.arm_stays_out
    ):
        robot.arm.move(STRETCHED)
        return {"success": False}
    robot.arm.move(TUCKED)
    return {"success": True}


def can_in_reach(world: Armadillo) -> str | None:
    """A can that stands on a table, near enough to the arm; a fallen one is not recognised."""
    x, y, yaw = world.robot.base.place
    foot = (x + SHOULDER_AHEAD_M * math.cos(yaw), y + SHOULDER_AHEAD_M * math.sin(yaw))
    for name in world.room.cans:
        can_x, can_y, _ = world.room.can_place(name)
        can = world.file.tables[name].can
        smallest, largest = GRASPABLE_RADII_M
        is_seen = world.room.is_to_pick(name) and smallest < can.radius * can.perceived_scale < largest
        if is_seen and math.dist(foot, (can_x, can_y)) < REACH_M:
            return name
    return None


def _perceived(world: Armadillo, name: str) -> tuple[float, float, float] | None:
    """Returns the place to grasp, as far as the robot can see: x, y, and the height above the table, in
    metres.

    None where nothing in the picture looks like a can.
    """
    file, noise = world.file, world.faults.noise
    can = file.tables[name].can
    top = top_seen(world.scene, world.robot.base.place, TABLE_TOP_M, _is_can)
    if top is None:
        return None
    x, y, top_z = top
    height = (top_z - TABLE_TOP_M) / 2 + GRASP_ABOVE_CENTRE_M
    if world.faults.draw("the can is seen elsewhere", can.misplaced):
        _, _, yaw = world.robot.base.place
        x -= MISPLACED_BY_M * math.cos(yaw)
        y -= MISPLACED_BY_M * math.sin(yaw)
    return (
        x + noise.gauss(0, file.faults.pose_noise_m),
        y + noise.gauss(0, file.faults.pose_noise_m),
        height + noise.gauss(0, file.faults.height_noise_m),
    )


def _is_can(colors: Colors) -> npt.NDArray[np.bool_]:
    """Red or orange, which the table is not."""
    red, _, blue = np.moveaxis(colors, -1, 0)
    is_can: npt.NDArray[np.bool_] = (blue < 0.35 * red) & (red > 60)
    return is_can
