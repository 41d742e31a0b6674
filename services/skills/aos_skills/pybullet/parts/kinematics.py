"""Inverse kinematics of the arm alone.

In a world of its own: in the robot's body, Bullet would also move the base to bring the hand there.
"""

import math
from pathlib import Path

from aos_skills.pybullet.parts.client import connect
from aos_skills.pybullet.parts.urdf import bare_arm_urdf, urdf_file

ARM_JOINTS = 7
ITERATIONS = 100
RESIDUAL_M = 1e-5


class ArmKinematics:
    """A Panda with its foot at the origin, which is only ever asked for angles."""

    def __init__(self, data: Path) -> None:
        self._client = connect()
        with urdf_file(bare_arm_urdf(data)) as path:
            self._arm: int = self._client.loadURDF(path, useFixedBase=True)
        joints = range(self._client.getNumJoints(self._arm))
        names = {self._client.getJointInfo(self._arm, joint)[12].decode(): joint for joint in joints}
        self._tip = names["panda_grasptarget"]

    def angles(self, place: tuple[float, float, float], start: list[float]) -> list[float]:
        """The seven joint angles in radians for the tip at `place` (metres, from the foot), hand down."""
        for joint, angle in enumerate(start):
            self._client.resetJointState(self._arm, joint, angle)
        down = self._client.getQuaternionFromEuler((math.pi, 0.0, 0.0))
        solution = self._client.calculateInverseKinematics(
            self._arm, self._tip, place, down, maxNumIterations=ITERATIONS, residualThreshold=RESIDUAL_M
        )
        return list(solution[:ARM_JOINTS])
