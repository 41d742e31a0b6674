"""Pick: grasp the cup in front of the robot from above. Whether it is in the hand, the fingers tell."""

import math
from typing import Any

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.robots.mobile_arm.grasp import grasp_from_above
from aos_skills.pybullet.worlds.cleanlab.seeing import place_of_cup
from aos_skills.pybullet.worlds.cleanlab.world import AHEAD_M, TABLE_TOP_M, CleanLab

GRASP_ABOVE_CENTRE_M = 0.008
CUP_CENTRE_M = 0.04
MISPLACED_BY_M = 0.1
LIFT_M = 0.25


def pick(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes and answers nothing. Where the robot sees no cup, it reaches for where one would stand."""
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
