"""The mobile manipulator: base, arm and gripper, moved by motors while simulated time passes.

Every motion is a loop over one simulation step and `on_tick`, where the owner publishes what the sensors give
and looks whether somebody wants the robot to stop.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pybullet

from aos_skills.pybullet.kinematics import ArmKinematics
from aos_skills.pybullet.robot_model import (
    ARM_JOINTS,
    BASE_JOINTS,
    FINGER_JOINTS,
    robot_urdf,
    urdf_file,
)
from aos_skills.pybullet.scene import STEP_S, Scene

__all__ = ["MOST_GAP_M", "TUCKED", "Robot"]

ARM_MOUNT_M = (0.25, 0.0, 0.39)
TUCKED = (0.0, -0.9, 0.0, -2.6, 0.0, 2.2, 0.785)
"""Arm joint angles in radians: folded over the base, hand down."""
MOST_GAP_M = 0.08
GRIP_FORCE_N = 25.0
DRIVE_SPEED_M_S = 1.0
TURN_SPEED_RAD_S = 1.2
DRIVE_ACCELERATION_M_S2 = 0.8
ARM_SPEED_RAD_S = 1.2
IK_EVERY_STEPS = 24
"""Solved once, inverse kinematics misses by centimetres; solved again on the way it arrives."""


class Robot:
    """The robot in a scene, standing still with the arm tucked when it is made."""

    def __init__(self, scene: Scene, on_tick: Callable[[], None]) -> None:
        self._client = client = scene.client
        self._scene = scene
        self.on_tick = on_tick
        with urdf_file(robot_urdf(scene.data, ARM_MOUNT_M)) as path:
            self.body: int = client.loadURDF(
                path, useFixedBase=True, flags=pybullet.URDF_ENABLE_CACHED_GRAPHICS_SHAPES
            )
        joints = range(client.getNumJoints(self.body))
        names = {client.getJointInfo(self.body, joint)[1].decode(): joint for joint in joints}
        links = {client.getJointInfo(self.body, joint)[12].decode(): joint for joint in joints}
        self._base = [names[name] for name in BASE_JOINTS]
        self._arm = [names[name] for name in ARM_JOINTS]
        self._fingers = [names[name] for name in FINGER_JOINTS]
        self._tip = links["panda_grasptarget"]
        self._kinematics = ArmKinematics(scene.data)
        self._arm_target = list(TUCKED)
        self._gap_target = MOST_GAP_M
        self._place_at(scene.file.robot.x, scene.file.robot.y, scene.file.robot.yaw)
        for finger in self._fingers:
            client.changeDynamics(self.body, finger, lateralFriction=1.5, spinningFriction=0.02)
        self.wait(0.2)

    # --- sensing -------------------------------------------------------------------------------------

    @property
    def base_place(self) -> tuple[float, float, float]:
        """x, y in metres, yaw in radians."""
        x, y, yaw = (self._client.getJointState(self.body, joint)[0] for joint in self._base)
        return x, y, yaw

    @property
    def arm_angles(self) -> list[float]:
        """Of the seven joints, in radians."""
        return [self._client.getJointState(self.body, joint)[0] for joint in self._arm]

    @property
    def gap_m(self) -> float:
        """Between the fingers."""
        return float(sum(self._client.getJointState(self.body, joint)[0] for joint in self._fingers))

    def finger_forces_n(self) -> tuple[float, float]:
        """What each finger presses on things that are not the other finger."""
        forces = []
        for finger in self._fingers:
            contacts = self._client.getContactPoints(bodyA=self.body, linkIndexA=finger)
            forces.append(sum(contact[9] for contact in contacts if contact[2] != self.body))
        return forces[0], forces[1]

    def holds(self, body: int) -> bool:
        """Whether both fingers touch a body."""
        touched = (
            self._client.getContactPoints(bodyA=self.body, linkIndexA=finger, bodyB=body)
            for finger in self._fingers
        )
        return all(touched)

    def tip_place(self) -> tuple[float, float, float]:
        """The point between the finger tips, in metres."""
        x, y, z = self._client.getLinkState(self.body, self._tip, computeForwardKinematics=True)[0]
        return x, y, z

    def stop(self) -> None:
        """Holds still where it is; time does not pass."""
        self._push_base((0.0, 0.0, 0.0))
        self._arm_target = self.arm_angles

    # --- moving --------------------------------------------------------------------------------------

    def wait(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP_S)):
            self._tick()

    def drive_to(self, x: float, y: float, yaw: float) -> bool:
        """Turns, drives straight, turns; whether it arrived within the time that it should take."""
        at_x, at_y, _ = self.base_place
        if math.hypot(x - at_x, y - at_y) > 0.05:
            heading = math.atan2(y - at_y, x - at_x)
            if not self._turn_to(heading):
                return False
        return self._slide_to(x, y) and self._turn_to(yaw)

    def creep(self, distance_m: float) -> bool:
        """Drives straight ahead, or back."""
        x, y, yaw = self.base_place
        return self._slide_to(x + distance_m * math.cos(yaw), y + distance_m * math.sin(yaw))

    def move_arm(self, angles: tuple[float, ...]) -> bool:
        """Moves the arm joint by joint along straight lines; whether it arrived."""
        start = list(self._arm_target)
        way = max(abs(end - begin) for begin, end in zip(start, angles, strict=True))
        steps = max(round(way / ARM_SPEED_RAD_S / STEP_S), 1)
        for step in range(1, steps + 1):
            share = step / steps
            self._arm_target = [b + (e - b) * share for b, e in zip(start, angles, strict=True)]
            self._tick()
        self.wait(0.15)
        errors = [abs(a - b) for a, b in zip(self.arm_angles, angles, strict=True)]
        return max(errors) < 0.1

    def move_tip(self, place: tuple[float, float, float], speed_m_s: float = 0.35) -> bool:
        """Moves the point between the finger tips, hand down, along a straight line; whether it arrived."""
        start = self.tip_place()
        steps = max(round(math.dist(start, place) / speed_m_s / STEP_S), 1)
        for step in range(1, steps + 1):
            if step % IK_EVERY_STEPS == 1 or step == steps:
                share = min((step + IK_EVERY_STEPS) / steps, 1.0)
                at = tuple(b + (e - b) * share for b, e in zip(start, place, strict=True))
                self._arm_target = self._solved(at)
            self._tick()
        for _ in range(10):
            self._arm_target = self._solved(place)
            self.wait(0.1)
            if math.dist(self.tip_place(), place) < 0.003:
                break
        return math.dist(self.tip_place(), place) < 0.02

    def close_gripper(self) -> None:
        """Closes until the fingers meet each other or something."""
        self._gap_target = 0.0
        self.wait(0.6)

    def open_gripper(self) -> None:
        self._gap_target = MOST_GAP_M
        self.wait(0.5)

    # --- motors --------------------------------------------------------------------------------------

    def _tick(self) -> None:
        client = self._client
        client.setJointMotorControlArray(
            self.body,
            self._arm,
            pybullet.POSITION_CONTROL,
            targetPositions=self._arm_target,
            forces=[200.0] * len(self._arm),
            positionGains=[0.2] * len(self._arm),
        )
        client.setJointMotorControlArray(
            self.body,
            self._fingers,
            pybullet.POSITION_CONTROL,
            targetPositions=[self._gap_target / 2] * 2,
            forces=[GRIP_FORCE_N] * 2,
        )
        self._scene.step()
        self.on_tick()

    def _solved(self, place: tuple[float, ...]) -> list[float]:
        """Arm angles that bring the tip to a place with the hand pointing down."""
        x, y, yaw = self.base_place
        ahead, left = place[0] - x, place[1] - y
        foot_x, foot_y, foot_z = ARM_MOUNT_M
        in_arm_frame = (
            ahead * math.cos(yaw) + left * math.sin(yaw) - foot_x,
            -ahead * math.sin(yaw) + left * math.cos(yaw) - foot_y,
            place[2] - foot_z,
        )
        return self._kinematics.angles(in_arm_frame, self.arm_angles)

    def _slide_to(self, x: float, y: float) -> bool:
        at_x, at_y, _ = self.base_place
        way = math.hypot(x - at_x, y - at_y)
        deadline_s = self._scene.time_s + 3.0 + 3 * way / DRIVE_SPEED_M_S
        speed = 0.0
        while self._scene.time_s < deadline_s:
            at_x, at_y, _ = self.base_place
            left = math.hypot(x - at_x, y - at_y)
            if left < 0.004:
                self._push_base((0.0, 0.0, 0.0))
                self.wait(0.1)
                return True
            faster = speed + DRIVE_ACCELERATION_M_S2 * STEP_S
            speed = min(faster, DRIVE_SPEED_M_S, math.sqrt(2 * DRIVE_ACCELERATION_M_S2 * left))
            self._push_base((speed * (x - at_x) / left, speed * (y - at_y) / left, 0.0))
            self._tick()
        self._push_base((0.0, 0.0, 0.0))
        return False

    def _turn_to(self, yaw: float) -> bool:
        deadline_s = self._scene.time_s + 8.0
        while self._scene.time_s < deadline_s:
            error = math.remainder(yaw - self.base_place[2], 2 * math.pi)
            if abs(error) < 0.003:
                self._push_base((0.0, 0.0, 0.0))
                return True
            self._push_base((0.0, 0.0, max(-TURN_SPEED_RAD_S, min(TURN_SPEED_RAD_S, 3 * error))))
            self._tick()
        self._push_base((0.0, 0.0, 0.0))
        return False

    def _push_base(self, velocities: tuple[float, float, float]) -> None:
        self._client.setJointMotorControlArray(
            self.body,
            self._base,
            pybullet.VELOCITY_CONTROL,
            targetVelocities=velocities,
            forces=[4000.0, 4000.0, 2000.0],
        )

    def _place_at(self, x: float, y: float, yaw: float) -> None:
        """Only before time begins."""
        for joint, value in zip(self._base, (x, y, yaw), strict=True):
            self._client.resetJointState(self.body, joint, value)
        for joint, value in zip(self._arm, TUCKED, strict=True):
            self._client.resetJointState(self.body, joint, value)
        for joint in self._fingers:
            self._client.resetJointState(self.body, joint, MOST_GAP_M / 2)
        self._push_base((0.0, 0.0, 0.0))
