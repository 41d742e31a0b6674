"""The mobile manipulator: base, arm and gripper, each moved by motors while simulated time passes.

Its description joins a Husky base and a Panda arm, both of `pybullet_data`, into one URDF. The base stands on
three joints, along x, along y and about z, instead of on its wheels: Bullet's skid steering slips by amounts
that depend on the time step, and the robot would need a localisation system to arrive anywhere. The joints
are driven by motors of limited force, step by step, so that the base still has mass, gathers speed, bumps
into things and stalls.
"""

from pathlib import Path
from xml.etree import ElementTree

import pybullet

from aos_skills.pybullet.parts.arm import Arm
from aos_skills.pybullet.parts.gripper import Gripper
from aos_skills.pybullet.parts.planar_base import PlanarBase
from aos_skills.pybullet.parts.scene import Scene, Vector
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
