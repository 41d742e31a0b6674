"""Simulated time and the bodies in it."""

from collections.abc import Callable
from pathlib import Path

import pybullet
import pybullet_data

from aos_skills.pybullet.parts.client import connect

STEP_S = 1 / 240

Vector = tuple[float, float, float]
Color = tuple[float, float, float, float]


class Scene:
    """Owns the pybullet client. `step` is the only way that time passes.

    `motors` run before each step and command the joints; `watchers` run after it, where the owner publishes
    what the sensors give, and looks whether somebody wants the robot to stop.
    """

    def __init__(self) -> None:
        self.client = connect()
        self.data = Path(pybullet_data.getDataPath())
        self.time_s = 0.0
        self.motors: list[Callable[[], None]] = []
        self.watchers: list[Callable[[], None]] = []
        self.client.setGravity(0, 0, -9.81)
        self.client.setTimeStep(STEP_S)

    def step(self) -> None:
        for motor in self.motors:
            motor()
        self.client.stepSimulation()
        self.time_s += STEP_S
        for watcher in self.watchers:
            watcher()

    def wait(self, seconds: float) -> None:
        for _ in range(round(seconds / STEP_S)):
            self.step()

    def close(self) -> None:
        self.client.disconnect()

    def place(self, body: int) -> Vector:
        """Returns the place of a body's centre, in metres."""
        x, y, z = self.client.getBasePositionAndOrientation(body)[0]
        return x, y, z

    def uprightness(self, body: int) -> float:
        """The cosine of a body's tilt: 1 when it stands, 0 when it lies."""
        turned = self.client.getBasePositionAndOrientation(body)[1]
        return float(self.client.getMatrixFromQuaternion(turned)[8])

    def box(self, half: Vector, at: Vector, color: Color, *, yaw: float = 0.0) -> int:
        """A box that never moves, by half its sides."""
        client = self.client
        body: int = client.createMultiBody(
            0,
            client.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half),
            client.createVisualShape(pybullet.GEOM_BOX, halfExtents=half, rgbaColor=color),
            at,
            client.getQuaternionFromEuler((0, 0, yaw)),
        )
        client.changeDynamics(body, -1, lateralFriction=0.9)
        return body

    def cylinder(self, radius: float, height: float, at: Vector, color: Color, mass: float = 0.0) -> int:
        """A standing cylinder by its centre; it never moves if it has no mass."""
        client = self.client
        body: int = client.createMultiBody(
            mass,
            client.createCollisionShape(pybullet.GEOM_CYLINDER, radius=radius, height=height),
            client.createVisualShape(pybullet.GEOM_CYLINDER, radius=radius, length=height, rgbaColor=color),
            at,
        )
        return body
