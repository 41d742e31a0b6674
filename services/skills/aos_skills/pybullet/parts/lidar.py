"""A lidar that turns level: the way that each ray goes before it meets something."""

import math

import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.scene import Scene

RAYS = 120
MIN_RANGE_M = 0.12
MAX_RANGE_M = 3.5


class Lidar:
    """Sits on a link of the robot, which its rays do not see because they start outside of it."""

    def __init__(self, scene: Scene, body: int, link: int) -> None:
        self._scene = scene
        self._body = body
        self._link = link
        self.angles: npt.NDArray[np.float64] = np.arange(RAYS) * 2 * math.pi / RAYS
        """The angles of the rays, in radians from straight ahead to the left."""

    def turn(self) -> npt.NDArray[np.float64]:
        """The ranges of one turn, in metres, one a ray; MAX_RANGE_M where a ray meets nothing."""
        client = self._scene.client
        at, turned = client.getLinkState(self._body, self._link, computeForwardKinematics=True)[:2]
        yaw = client.getEulerFromQuaternion(turned)[2]
        level = np.stack([np.cos(self.angles + yaw), np.sin(self.angles + yaw), np.zeros(RAYS)], axis=1)
        starts, ends = np.asarray(at) + level * MIN_RANGE_M, np.asarray(at) + level * MAX_RANGE_M
        hits = client.rayTestBatch(starts.tolist(), ends.tolist())
        return MIN_RANGE_M + np.array([hit[2] for hit in hits]) * (MAX_RANGE_M - MIN_RANGE_M)
