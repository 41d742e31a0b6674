"""Release: hold out what is in the hand over what is in front, and let go."""

import math
from typing import Any

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.worlds.cleanlab.world import AHEAD_M, BIN_TOP_M, CleanLab

ABOVE_BIN_M = 0.15
SETTLING_S = 0.5


def release(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes and answers nothing."""
    robot = world.robot
    x, y, yaw = robot.base.place
    over = (x + AHEAD_M * math.cos(yaw), y + AHEAD_M * math.sin(yaw), BIN_TOP_M + ABOVE_BIN_M)
    robot.arm.move_tip(over)
    robot.gripper.open()
    world.scene.wait(SETTLING_S)
    robot.arm.move(TUCKED)
    return {}
