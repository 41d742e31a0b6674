"""A Husky base that carries a Panda arm with its gripper."""

from aos_skills.pybullet.robots.mobile_arm.robot import MobileArm

__all__ = ["MobileArm"]
