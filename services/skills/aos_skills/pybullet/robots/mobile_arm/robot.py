"""The mobile manipulator: base, arm and gripper, each moved by motors while simulated time passes."""

import pybullet

from aos_skills.pybullet.parts.arm import Arm
from aos_skills.pybullet.parts.gripper import Gripper
from aos_skills.pybullet.parts.planar_base import PlanarBase
from aos_skills.pybullet.parts.scene import Scene, Vector
from aos_skills.pybullet.parts.urdf import joints_and_links, urdf_file
from aos_skills.pybullet.robots.mobile_arm.description import mobile_arm_urdf

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
