"""The Panda arm, moved joint by joint or by the point between its finger tips.

Its inverse kinematics are solved in a world of their own: in the robot's body, Bullet would also move the
base to bring the hand there.
"""

import itertools
import math
from collections.abc import Callable
from pathlib import Path

import pybullet

from aos_skills.pybullet.parts.scene import STEP_S, Scene, Vector, connect
from aos_skills.pybullet.parts.urdf import bare_arm_urdf, urdf_file

_JOINT_COUNT = 7
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
        return list(solution[:_JOINT_COUNT])


ARM_JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
TUCKED = (0.0, -0.9, 0.0, -2.6, 0.0, 2.2, 0.785)
"""Joint angles in radians: folded over the base, hand down."""
SPEED_RAD_S = 1.2
FORCE = 200.0
IK_EVERY_STEPS = 24
"""Solved once, inverse kinematics misses by centimetres; solved again on the way it arrives."""


class Arm:
    """Tucked when it is made.

    `base_place` gives x, y and yaw of what carries the arm, and `mount_m` is the arm's foot on it.
    """

    def __init__(
        self,
        scene: Scene,
        body: int,
        joints: dict[str, int],
        links: dict[str, int],
        mount_m: Vector,
        base_place: Callable[[], Vector],
    ) -> None:
        self._scene = scene
        self._client = scene.client
        self._body = body
        self._joints = [joints[name] for name in ARM_JOINTS]
        self._tip = links["panda_grasptarget"]
        self._mount_m = mount_m
        self._base_place = base_place
        self._kinematics = ArmKinematics(scene.data)
        self._target = list(TUCKED)
        for joint, angle in zip(self._joints, TUCKED, strict=True):
            self._client.resetJointState(body, joint, angle)
        scene.motors.append(self._hold)

    @property
    def angles(self) -> list[float]:
        """The angles of the seven joints, in radians."""
        return [self._client.getJointState(self._body, joint)[0] for joint in self._joints]

    def tip_place(self) -> Vector:
        """The point between the finger tips, in metres."""
        x, y, z = self._client.getLinkState(self._body, self._tip, computeForwardKinematics=True)[0]
        return x, y, z

    def stop(self) -> None:
        """Holds still where it is; time does not pass."""
        self._target = self.angles

    def move(self, angles: tuple[float, ...]) -> bool:
        """Moves joint by joint along straight lines; whether it arrived."""
        start = list(self._target)
        way = max(abs(end - begin) for begin, end in zip(start, angles, strict=True))
        steps = max(round(way / SPEED_RAD_S / STEP_S), 1)
        for step in range(1, steps + 1):
            share = step / steps
            self._target = [b + (e - b) * share for b, e in zip(start, angles, strict=True)]
            self._scene.step()
        self._scene.wait(0.15)
        errors = [abs(a - b) for a, b in zip(self.angles, angles, strict=True)]
        return max(errors) < 0.1

    def move_tip(self, place: Vector, speed_m_s: float = 0.35) -> bool:
        """Moves the point between the finger tips, hand down, along a straight line; whether it arrived."""
        start = self.tip_place()
        steps = max(round(math.dist(start, place) / speed_m_s / STEP_S), 1)
        for step in range(1, steps + 1):
            if step % IK_EVERY_STEPS == 1 or step == steps:
                share = min((step + IK_EVERY_STEPS) / steps, 1.0)
                at = tuple(b + (e - b) * share for b, e in zip(start, place, strict=True))
                self._target = self._solved(at)
            self._scene.step()
        for _ in range(10):
            self._target = self._solved(place)
            self._scene.wait(0.1)
            if math.dist(self.tip_place(), place) < 0.003:
                break
        return math.dist(self.tip_place(), place) < 0.02

    def trace(self, way: list[Vector], speed_m_s: float = 0.08) -> None:
        """Moves the tip, hand down, through all points of a way without a stop."""
        for start, place in itertools.pairwise([self.tip_place(), *way]):
            self._target = self._solved(place)
            self._scene.wait(max(math.dist(start, place) / speed_m_s, STEP_S))

    def _hold(self) -> None:
        self._client.setJointMotorControlArray(
            self._body,
            self._joints,
            pybullet.POSITION_CONTROL,
            targetPositions=self._target,
            forces=[FORCE] * len(self._joints),
            positionGains=[0.2] * len(self._joints),
        )

    def _solved(self, place: tuple[float, ...]) -> list[float]:
        """Angles that bring the tip to a place with the hand pointing down."""
        x, y, yaw = self._base_place()
        ahead, left = place[0] - x, place[1] - y
        foot_x, foot_y, foot_z = self._mount_m
        in_arm_frame = (
            ahead * math.cos(yaw) + left * math.sin(yaw) - foot_x,
            -ahead * math.sin(yaw) + left * math.cos(yaw) - foot_y,
            place[2] - foot_z,
        )
        return self._kinematics.angles(in_arm_frame, self.angles)
