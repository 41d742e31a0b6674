"""Retract: ask the motion planner once more for a way to fold the arm."""

from typing import Any

from aos_skills.pybullet.parts.arm import TUCKED
from aos_skills.pybullet.worlds.armadillo.world import FOLDED_ELBOW_RAD, Armadillo


def retract(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing. `success` is false if the arm stays where it is; what is in the hand stays there."""
    is_out = world.robot.arm.angles[3] > FOLDED_ELBOW_RAD
    if is_out and world.faults.draw("the arm stays out again", world.file.faults.arm_stays_out_again):
        return {"success": False}
    return {"success": world.robot.arm.move(TUCKED)}
