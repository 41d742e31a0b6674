"""Simulated time and the bodies in it, behind a connection to Bullet that leaves standard output alone."""

import ctypes
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pybullet
import pybullet_data
from pybullet_utils.bullet_client import BulletClient

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


def connect() -> BulletClient:
    """A simulation in this process, with no window.

    Bullet prints its own arguments, from C, whenever it connects; standard output is shut for that long.
    Standard error, where Bullet's warnings go, stays open.
    """
    with _silent_stdout():
        return BulletClient(connection_mode=pybullet.DIRECT)


@contextmanager
def _silent_stdout() -> Iterator[None]:
    """C buffers what it prints, so it is flushed on either side."""
    flush_c = ctypes.CDLL(None).fflush
    flush_c(None)
    stdout = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
        flush_c(None)
    finally:
        os.dup2(stdout, 1)
        os.close(stdout)
        os.close(nowhere)
