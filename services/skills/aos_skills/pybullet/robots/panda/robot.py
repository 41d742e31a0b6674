"""The Panda on its table, with a pen in the hand."""

import pybullet

from aos_skills.pybullet.parts.arm import Arm
from aos_skills.pybullet.parts.scene import Scene, Vector
from aos_skills.pybullet.parts.urdf import joints_and_links

PEN_RADIUS_M = 0.005
PEN_LENGTH_M = 0.12
PEN_BELOW_GRASP_M = 0.08
"""The distance of the pen's tip from the point between the fingers."""
FINGERS = ("panda_finger_joint1", "panda_finger_joint2")
_BLUE = (0.1, 0.15, 0.5, 1)


class PandaWithPen:
    """Stands at the origin with the arm tucked when it is made; the pen is a body fixed to the hand."""

    def __init__(self, scene: Scene) -> None:
        client = scene.client
        self.body: int = client.loadURDF(
            str(scene.data / "franka_panda" / "panda.urdf"),
            useFixedBase=True,
            flags=pybullet.URDF_ENABLE_CACHED_GRAPHICS_SHAPES,
        )
        joints, links = joints_and_links(client, self.body)
        self.arm = Arm(scene, self.body, joints, links, (0.0, 0.0, 0.0), lambda: (0.0, 0.0, 0.0))
        for name in FINGERS:
            client.resetJointState(self.body, joints[name], PEN_RADIUS_M)
        hand = links["panda_grasptarget"]
        x, y, z = self.arm.tip_place()
        below = PEN_BELOW_GRASP_M - PEN_LENGTH_M / 2
        self.pen = scene.cylinder(PEN_RADIUS_M, PEN_LENGTH_M, (x, y, z - below), _BLUE, 0.015)
        for link in range(-1, client.getNumJoints(self.body)):
            client.setCollisionFilterPair(self.body, self.pen, link, -1, 0)
        client.createConstraint(
            self.body, hand, self.pen, -1, pybullet.JOINT_FIXED, (0, 0, 0), (0, 0, below), (0, 0, 0)
        )
        scene.wait(0.3)

    def draw(self, way: list[Vector]) -> None:
        """Moves the pen's tip along a way on a surface, coming from above and going back up."""
        grasp = [(x, y, z + PEN_BELOW_GRASP_M) for x, y, z in way]
        (x, y, z), (end_x, end_y, end_z) = grasp[0], grasp[-1]
        self.arm.move_tip((x, y, z + 0.05))
        self.arm.trace(grasp)
        self.arm.move_tip((end_x, end_y, end_z + 0.05))

    def stop(self) -> None:
        """Holds still where it is; time does not pass."""
        self.arm.stop()
