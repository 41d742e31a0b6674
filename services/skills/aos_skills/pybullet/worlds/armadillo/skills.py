"""The skills of the room: each takes the fields of its call, and answers with the result."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.parts.boom_camera import Colors, top_seen
from aos_skills.pybullet.robots.mobile_arm.robot import SHOULDER_AHEAD_M, grasp_from_above
from aos_skills.pybullet.worlds.armadillo.room import TABLE_TOP_M, TRAY_FROM_PERSON_M, TRAY_TOP_M
from aos_skills.pybullet.worlds.armadillo.world import FOLDED_ELBOW_RAD, Armadillo

CROSSING = (0.0, 0.0)
"""All ways between the places lead over the middle of the room."""


def navigate(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Drives to a place in the room.

    Takes `x` and `y` in metres and `yaw` in radians; `success` says whether it arrived.
    """
    base = world.robot.base
    x, y, yaw = float(fields["x"]), float(fields["y"]), float(fields["yaw"])
    at_x, at_y, at_yaw = base.place
    if math.hypot(x - at_x, y - at_y) < 0.05:
        return {"success": base.drive_to(x, y, yaw)}
    has_crossed = base.drive_to(*CROSSING, at_yaw)
    return {"success": has_crossed and base.drive_to(x, y, yaw)}


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
    """Reaches for the can on the table where the robot stands, closes the fingers, lifts, folds the arm.

    Takes nothing. `success` is false if the arm stays out; a missed or dropped can is not noticed.
    """
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


SENSING_S = 0.5


def sense(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Stands still while the sensors publish, and answers with what they say at the end; takes nothing."""
    world.scene.wait(SENSING_S)
    return {name: value for readings in world.sensors().values() for name, value in readings.items()}


def retract(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Asks the motion planner once more for a way to fold the arm; takes nothing.

    `success` is false if the arm stays where it is; what is in the hand stays there.
    """
    is_out = world.robot.arm.angles[3] > FOLDED_ELBOW_RAD
    if is_out and world.faults.draw("the arm stays out again", world.file.faults.arm_stays_out_again):
        return {"success": False}
    return {"success": world.robot.arm.move(TUCKED)}


NEAR_M = 1.5
APPROACH_M = 0.25
RELEASE_HEIGHT_M = 0.05


def serve(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Holds out what is in the hand over the person's tray, and lets go.

    Takes nothing; reports a delivery whatever happened, as the original robot did.
    """
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
