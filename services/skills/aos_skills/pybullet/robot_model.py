"""The robot's description: a Husky base that carries a Panda arm, joined into one URDF.

Both come from `pybullet_data` and are read when the world is built. The base stands on three joints, along x,
along y and about z, instead of on its wheels: Bullet's skid steering slips by amounts that depend on the time
step, and the robot would need a localisation system to arrive anywhere. The joints are driven by motors of
limited force, step by step, so that the base still has mass, gathers speed, bumps into things and stalls.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

__all__ = ["ARM_JOINTS", "BASE_JOINTS", "FINGER_JOINTS", "bare_arm_urdf", "robot_urdf", "urdf_file"]

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
ARM_JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
FINGER_JOINTS = ("panda_finger_joint1", "panda_finger_joint2")

_PLANAR_JOINTS = """
<robot name="armadillo">
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
"""What Bullet takes for a link without any, with a page of warnings."""
_CHASSIS_HEIGHT_M = 0.14493
"""Of Husky's base_link above the floor."""


def robot_urdf(data: Path, mount_m: tuple[float, float, float]) -> str:
    """The URDF text. `data` is pybullet_data's folder; `mount_m` the arm's foot in the base's floor frame."""
    x, y, z = mount_m
    robot = ElementTree.fromstring(
        _PLANAR_JOINTS.format(inertia=_SMALL_INERTIA, mount=f"{x} {y} {z - _CHASSIS_HEIGHT_M}")
    )
    robot.extend(_parts(data / "husky" / "husky.urdf"))
    robot.extend(_parts(data / "franka_panda" / "panda.urdf"))
    for link in robot.iter("link"):
        if link.get("name", "").endswith("_wheel_link"):
            _drop(link, "collision")
        if link.get("name") == "base_footprint":
            link.append(ElementTree.fromstring(_SMALL_INERTIA))
        if link.find("inertial") is None:
            link.append(ElementTree.fromstring(_UNIT_INERTIA))
    return ElementTree.tostring(robot, encoding="unicode")


def bare_arm_urdf(data: Path) -> str:
    """The arm without shapes, which take half a second to load: joints are all that kinematics needs."""
    arm = ElementTree.parse(data / "franka_panda" / "panda.urdf").getroot()
    for link in arm.iter("link"):
        _drop(link, "visual")
        _drop(link, "collision")
    return ElementTree.tostring(arm, encoding="unicode")


@contextmanager
def urdf_file(text: str) -> Iterator[str]:
    """A path where Bullet can read a description from; in memory, so that a crash leaves nothing behind."""
    file = os.memfd_create("aos-urdf")
    try:
        os.write(file, text.encode())
        yield f"/proc/self/fd/{file}"
    finally:
        os.close(file)


def _parts(urdf: Path) -> list[ElementTree.Element]:
    """Materials, links and joints of a URDF, with absolute mesh paths."""
    root = ElementTree.parse(urdf).getroot()
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "").removeprefix("package://")
        mesh.set("filename", str(urdf.parent / name))
    for joint in root.iter("joint"):
        # Husky's IMU mount holds an unexpanded xacro expression; nothing uses the link.
        origin = joint.find("origin")
        if origin is not None and "$(" in origin.get("xyz", ""):
            joint.remove(origin)
    return [part for part in root if part.tag in ("material", "link", "joint")]


def _drop(link: ElementTree.Element, tag: str) -> None:
    for part in link.findall(tag):
        link.remove(part)
