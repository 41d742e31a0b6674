"""Grasping from above, which is the same for a can and a cup."""

from aos_skills.pybullet.robots.mobile_arm.robot import MobileArm

SHOULDER_AHEAD_M = 0.25
"""The distance of the arm's foot from the middle of the base."""
SLOWLY_M_S = 0.15


def grasp_from_above(robot: MobileArm, place: tuple[float, float, float], above_m: float) -> None:
    """Reaches down to `place` (metres), closes the fingers and lifts to the height `above_m`."""
    x, y, height = place
    robot.arm.move_tip((x, y, above_m))
    robot.arm.move_tip((x, y, height), speed_m_s=SLOWLY_M_S)
    robot.gripper.close()
    robot.arm.move_tip((x, y, above_m))
