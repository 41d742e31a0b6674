"""Robot descriptions: read, joined, and handed to Bullet without a file on disk."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

from pybullet_utils.bullet_client import BulletClient


@contextmanager
def urdf_file(text: str) -> Iterator[str]:
    """A path where Bullet can read a description from; in memory, so that a crash leaves nothing behind."""
    file = os.memfd_create("aos-urdf")
    try:
        os.write(file, text.encode())
        yield f"/proc/self/fd/{file}"
    finally:
        os.close(file)


def parts_of(urdf: Path) -> list[ElementTree.Element]:
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


def bare_arm_urdf(data: Path) -> str:
    """The Panda without shapes, which take half a second to load: joints are all that kinematics needs."""
    arm = ElementTree.parse(data / "franka_panda" / "panda.urdf").getroot()
    for link in arm.iter("link"):
        drop(link, "visual")
        drop(link, "collision")
    return ElementTree.tostring(arm, encoding="unicode")


def drop(link: ElementTree.Element, tag: str) -> None:
    """Takes a link's shapes, or others of its elements, away."""
    for part in link.findall(tag):
        link.remove(part)


def joints_and_links(client: BulletClient, body: int) -> tuple[dict[str, int], dict[str, int]]:
    """A body's joints, and its links, by name."""
    infos = [client.getJointInfo(body, joint) for joint in range(client.getNumJoints(body))]
    joints = {info[1].decode(): number for number, info in enumerate(infos)}
    links = {info[12].decode(): number for number, info in enumerate(infos)}
    return joints, links
