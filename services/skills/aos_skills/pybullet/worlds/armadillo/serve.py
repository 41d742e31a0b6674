"""Serve: hold out what is in the hand over the person's tray, and let go."""

import math
from typing import Any

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.worlds.armadillo.room import TRAY_FROM_PERSON_M, TRAY_TOP_M
from aos_skills.pybullet.worlds.armadillo.world import Armadillo

NEAR_M = 1.5
APPROACH_M = 0.25
LIFT_M = 0.22
RELEASE_HEIGHT_M = 0.05


def serve(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing; reports a delivery whatever happened, as the original robot did."""
    robot, person = world.robot, world.file.person
    x, y, _yaw = robot.base.place
    tray = (person.x - TRAY_FROM_PERSON_M, person.y)
    if math.dist((x, y), tray) < NEAR_M:
        robot.base.creep(APPROACH_M)
        robot.arm.move_tip((*tray, TRAY_TOP_M + LIFT_M))
        robot.arm.move_tip((*tray, TRAY_TOP_M + RELEASE_HEIGHT_M), speed_m_s=0.15)
        robot.gripper.open()
        robot.arm.move_tip((*tray, TRAY_TOP_M + LIFT_M), speed_m_s=0.15)
        robot.arm.move(TUCKED)
        robot.base.creep(-APPROACH_M)
    else:
        robot.gripper.open()
    return {"success": True}
