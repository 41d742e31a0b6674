"""The skills of the laboratory: each takes the fields of its call, and answers with the result."""

import math
from typing import Any

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.robots.mobile_arm.robot import grasp_from_above
from aos_skills.pybullet.worlds.cleanlab.world import AHEAD_M, BIN_TOP_M, TABLE_TOP_M, CleanLab, place_of_cup

LOOKING_S = 0.5


def look(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing; `is_there` says whether something red is on the table in front of the robot."""
    world.scene.wait(LOOKING_S)
    if place_of_cup(world) is not None:
        return {"is_there": not world.faults.draw("glare", world.file.faults.glare)}
    return {"is_there": world.faults.draw("a ghost", world.file.faults.ghost)}


AISLE_Y_M = 0.0


def navigate(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Drives along the aisle in the middle, and up to a station or a bin.

    Takes `x` and `y` in metres and `yaw` in radians; `success` says whether it arrived.
    """
    base = world.robot.base
    x, y, yaw = float(fields["x"]), float(fields["y"]), float(fields["yaw"])
    at_x, at_y, at_yaw = base.place
    if math.dist((at_x, at_y), (x, y)) < 0.05:
        return {"success": base.drive_to(x, y, yaw)}
    # It backs out of where it stands, without turning beside the table.
    in_aisle = base.creep(-abs(at_y - AISLE_Y_M)) if abs(at_y - AISLE_Y_M) > 0.05 else True
    along = abs(x - at_x) < 0.05 or base.drive_to(x, AISLE_Y_M, at_yaw)
    return {"success": in_aisle and along and base.drive_to(x, y, yaw)}


GRASP_ABOVE_CENTRE_M = 0.008
CUP_CENTRE_M = 0.04
MISPLACED_BY_M = 0.1
LIFT_M = 0.25


def pick(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Grasps the cup in front of the robot from above; takes and answers nothing.

    Where the robot sees no cup, it reaches for where one would stand. The fingers tell whether it is held.
    """
    robot, faults, noise = world.robot, world.file.faults, world.faults.noise
    x, y, yaw = robot.base.place
    at_x, at_y = x + AHEAD_M * math.cos(yaw), y + AHEAD_M * math.sin(yaw)
    place = place_of_cup(world)
    if place is not None:
        at_x, at_y = place
    if world.faults.draw("the cup is seen elsewhere", faults.misplaced):
        at_x, at_y = at_x - MISPLACED_BY_M * math.cos(yaw), at_y - MISPLACED_BY_M * math.sin(yaw)
    at_x, at_y = at_x + noise.gauss(0, faults.pose_noise_m), at_y + noise.gauss(0, faults.pose_noise_m)
    robot.gripper.open()
    height = TABLE_TOP_M + CUP_CENTRE_M + GRASP_ABOVE_CENTRE_M
    grasp_from_above(robot, (at_x, at_y, height), TABLE_TOP_M + LIFT_M)
    robot.arm.move(TUCKED)
    return {}


ABOVE_BIN_M = 0.15
SETTLING_S = 0.5


def release(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Lets go of what is in the hand over what is in front; takes and answers nothing."""
    robot = world.robot
    x, y, yaw = robot.base.place
    over = (x + AHEAD_M * math.cos(yaw), y + AHEAD_M * math.sin(yaw), BIN_TOP_M + ABOVE_BIN_M)
    robot.arm.move_tip(over)
    robot.gripper.open()
    world.scene.wait(SETTLING_S)
    robot.arm.move(TUCKED)
    return {}
