"""The mobile manipulator: base, arm and gripper, each moved by motors while simulated time passes.

Its description joins a Husky base and a Panda arm, both of `pybullet_data`, into one URDF. The base stands on
three joints, along x, along y and about z, instead of on its wheels: Bullet's skid steering slips by amounts
that depend on the time step, and the robot would need a localisation system to arrive anywhere. The joints
are driven by motors of limited force, step by step, so that the base still has mass, gathers speed, bumps
into things and stalls.
"""

import math
from pathlib import Path
from xml.etree import ElementTree

import pybullet

from aos_skills.pybullet.parts.arm import Arm
from aos_skills.pybullet.parts.scene import STEP_S, Scene, Vector
from aos_skills.pybullet.parts.urdf import drop, joints_and_links, parts_of, urdf_file

ARM_MOUNT_M = (0.25, 0.0, 0.39)


class MobileArm:
    """Stands still at `place` with the arm tucked and the gripper open when it is made."""

    def __init__(self, scene: Scene, place: Vector) -> None:
        with urdf_file(mobile_arm_urdf(scene.data, ARM_MOUNT_M)) as path:
            self.body: int = scene.client.loadURDF(
                path, useFixedBase=True, flags=pybullet.URDF_ENABLE_CACHED_GRAPHICS_SHAPES
            )
        joints, links = joints_and_links(scene.client, self.body)
        self.base = PlanarBase(scene, self.body, joints, place)
        self.arm = Arm(scene, self.body, joints, links, ARM_MOUNT_M, lambda: self.base.place)
        self.gripper = Gripper(scene, self.body, joints)
        scene.wait(0.2)

    def stop(self) -> None:
        """Holds still where it is; time does not pass."""
        self.base.stop()
        self.arm.stop()


_PLANAR_JOINTS = """
<robot name="mobile_arm">
  <link name="odom"/>
  <link name="slide_x">{inertia}</link>
  <link name="slide_y">{inertia}</link>
  <joint name="base_x" type="prismatic">
    <parent link="odom"/><child link="slide_x"/><axis xyz="1 0 0"/>
    <limit lower="-100" upper="100" effort="4000" velocity="3"/>
  </joint>
  <joint name="base_y" type="prismatic">
    <parent link="slide_x"/><child link="slide_y"/><axis xyz="0 1 0"/>
    <limit lower="-100" upper="100" effort="4000" velocity="3"/>
  </joint>
  <joint name="base_yaw" type="continuous">
    <parent link="slide_y"/><child link="base_footprint"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="arm_mount" type="fixed">
    <parent link="base_link"/><child link="panda_link0"/><origin xyz="{mount}" rpy="0 0 0"/>
  </joint>
</robot>
"""
_SMALL_INERTIA = (
    '<inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
)
_UNIT_INERTIA = (
    '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)
"""Bullet takes these values for a link without any, with a page of warnings."""
_CHASSIS_HEIGHT_M = 0.14493
"""The height of Husky's base_link above the floor."""


def mobile_arm_urdf(data: Path, mount_m: tuple[float, float, float]) -> str:
    """The URDF text. `data` is pybullet_data's folder; `mount_m` the arm's foot in the base's floor frame."""
    x, y, z = mount_m
    robot = ElementTree.fromstring(
        _PLANAR_JOINTS.format(inertia=_SMALL_INERTIA, mount=f"{x} {y} {z - _CHASSIS_HEIGHT_M}")
    )
    robot.extend(parts_of(data / "husky" / "husky.urdf"))
    robot.extend(parts_of(data / "franka_panda" / "panda.urdf"))
    for link in robot.iter("link"):
        if link.get("name", "").endswith("_wheel_link"):
            drop(link, "collision")
        if link.get("name") == "base_footprint":
            link.append(ElementTree.fromstring(_SMALL_INERTIA))
        if link.find("inertial") is None:
            link.append(ElementTree.fromstring(_UNIT_INERTIA))
    return ElementTree.tostring(robot, encoding="unicode")


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


BASE_JOINTS = ("base_x", "base_y", "base_yaw")
DRIVE_SPEED_M_S = 1.0
TURN_SPEED_RAD_S = 1.2
DRIVE_ACCELERATION_M_S2 = 0.8
FORCES = (4000.0, 4000.0, 2000.0)


class PlanarBase:
    """Stands still at `place` (x, y in metres, yaw in radians) when it is made."""

    def __init__(self, scene: Scene, body: int, joints: dict[str, int], place: Vector) -> None:
        self._scene = scene
        self._client = scene.client
        self._body = body
        self._joints = [joints[name] for name in BASE_JOINTS]
        for joint, value in zip(self._joints, place, strict=True):
            self._client.resetJointState(body, joint, value)
        self._push((0.0, 0.0, 0.0))

    @property
    def place(self) -> Vector:
        """x, y in metres, yaw in radians."""
        x, y, yaw = (self._client.getJointState(self._body, joint)[0] for joint in self._joints)
        return x, y, yaw

    def stop(self) -> None:
        """Holds still where it is; time does not pass."""
        self._push((0.0, 0.0, 0.0))

    def drive_to(self, x: float, y: float, yaw: float) -> bool:
        """Turns, drives straight, turns; whether it arrived within the time that it should take."""
        at_x, at_y, _ = self.place
        if math.hypot(x - at_x, y - at_y) > 0.05:
            heading = math.atan2(y - at_y, x - at_x)
            if not self._turn_to(heading):
                return False
        return self._slide_to(x, y) and self._turn_to(yaw)

    def creep(self, distance_m: float) -> bool:
        """Drives straight ahead, or back."""
        x, y, yaw = self.place
        return self._slide_to(x + distance_m * math.cos(yaw), y + distance_m * math.sin(yaw))

    def _slide_to(self, x: float, y: float) -> bool:
        at_x, at_y, _ = self.place
        way = math.hypot(x - at_x, y - at_y)
        deadline_s = self._scene.time_s + 3.0 + 3 * way / DRIVE_SPEED_M_S
        speed = 0.0
        while self._scene.time_s < deadline_s:
            at_x, at_y, _ = self.place
            distance_m = math.hypot(x - at_x, y - at_y)
            if distance_m < 0.004:
                self.stop()
                self._scene.wait(0.1)
                return True
            faster = speed + DRIVE_ACCELERATION_M_S2 * STEP_S
            speed = min(faster, DRIVE_SPEED_M_S, math.sqrt(2 * DRIVE_ACCELERATION_M_S2 * distance_m))
            self._push((speed * (x - at_x) / distance_m, speed * (y - at_y) / distance_m, 0.0))
            self._scene.step()
        self.stop()
        return False

    def _turn_to(self, yaw: float) -> bool:
        deadline_s = self._scene.time_s + 8.0
        while self._scene.time_s < deadline_s:
            error = math.remainder(yaw - self.place[2], 2 * math.pi)
            if abs(error) < 0.003:
                self.stop()
                return True
            self._push((0.0, 0.0, max(-TURN_SPEED_RAD_S, min(TURN_SPEED_RAD_S, 3 * error))))
            self._scene.step()
        self.stop()
        return False

    def _push(self, velocities: Vector) -> None:
        self._client.setJointMotorControlArray(
            self._body, self._joints, pybullet.VELOCITY_CONTROL, targetVelocities=velocities, forces=FORCES
        )


FINGER_JOINTS = ("panda_finger_joint1", "panda_finger_joint2")
MAX_GAP_M = 0.08
GRIP_FORCE_N = 25.0
FEELS_GAP_M, FEELS_FORCE_N = 0.0003, 1.0
"""A thing that is thinner, or presses less, is taken for nothing."""


class Gripper:
    """Open when it is made."""

    def __init__(self, scene: Scene, body: int, joints: dict[str, int]) -> None:
        self._scene = scene
        self._client = scene.client
        self._body = body
        self._fingers = [joints[name] for name in FINGER_JOINTS]
        self._gap_target = MAX_GAP_M
        for finger in self._fingers:
            self._client.resetJointState(body, finger, MAX_GAP_M / 2)
            self._client.changeDynamics(body, finger, lateralFriction=1.5, spinningFriction=0.02)
        scene.motors.append(self._hold)

    @property
    def gap_m(self) -> float:
        """The distance between the fingers."""
        return float(sum(self._client.getJointState(self._body, joint)[0] for joint in self._fingers))

    def forces_n(self) -> tuple[float, float]:
        """Returns the forces with which each finger presses on things that are not the other finger."""
        forces = []
        for finger in self._fingers:
            contacts = self._client.getContactPoints(bodyA=self._body, linkIndexA=finger)
            forces.append(sum(contact[9] for contact in contacts if contact[2] != self._body))
        return forces[0], forces[1]

    @property
    def feels_something(self) -> bool:
        """True while the fingers, by their own sensors, have something between them."""
        return self.gap_m > FEELS_GAP_M and min(self.forces_n()) > FEELS_FORCE_N

    def holds(self, body: int) -> bool:
        """Returns whether both fingers touch a body."""
        touched = (
            self._client.getContactPoints(bodyA=self._body, linkIndexA=finger, bodyB=body)
            for finger in self._fingers
        )
        return all(touched)

    def close(self) -> None:
        """Closes until the fingers meet each other or something."""
        self._gap_target = 0.0
        self._scene.wait(0.6)

    def open(self) -> None:
        self._gap_target = MAX_GAP_M
        self._scene.wait(0.5)

    def _hold(self) -> None:
        self._client.setJointMotorControlArray(
            self._body,
            self._fingers,
            pybullet.POSITION_CONTROL,
            targetPositions=[self._gap_target / 2] * 2,
            forces=[GRIP_FORCE_N] * 2,
        )
