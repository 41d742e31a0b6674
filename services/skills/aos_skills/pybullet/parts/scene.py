"""Simulated time, the bodies in it and pictures of them, behind a connection to Bullet.

The software renderer needs no screen and no GPU.
"""

import ctypes
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pybullet
import pybullet_data
from PIL import Image
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


PICTURE_SIZE = (480, 360)
CLOSE_UP_SIZE = (240, 360)
FRAME_EVERY_S = 3.0
FRAME_SHOWN_MS = 300
FIELD_OF_VIEW_DEG = 50
SUN = (3.0, -4.0, 7.0)
BORDER_PX = 2
"""The width of white between a picture and its close-up."""


class Pose(NamedTuple):
    """The place of a camera, and how it is turned."""

    eye: Vector
    looks_at: Vector
    up: Vector = (0, 0, 1)


def photograph(
    scene: Scene,
    pose: Pose,
    size: tuple[int, int],
    *,
    sun: Vector = SUN,
    field_of_view_deg: float = FIELD_OF_VIEW_DEG,
    shadow: bool = True,
) -> Image.Image:
    """Returns the picture of a camera, in color; `size` is width and height in pixels."""
    client = scene.client
    width, height = size
    _, _, pixels, _, _ = client.getCameraImage(
        width,
        height,
        client.computeViewMatrix(*pose),
        client.computeProjectionMatrixFOV(field_of_view_deg, width / height, 0.1, 30),
        shadow=int(shadow),
        lightDirection=sun,
        renderer=pybullet.ER_TINY_RENDERER,
    )
    rgba = np.reshape(np.asarray(pixels, dtype=np.uint8), (height, width, 4))
    return Image.fromarray(rgba[:, :, :3])


class Camera:
    """Looks into a room from its open side, with a close-up beside it if the world has one to show.

    `close_up` gives the close-up's pose.
    """

    def __init__(self, scene: Scene, pose: Pose, close_up: Callable[[], Pose] | None = None) -> None:
        self._scene = scene
        self._pose = pose
        self._close_up = close_up
        self._frames: list[Image.Image] = []
        self._next_frame_s = 0.0

    def watch(self) -> None:
        """Takes a frame for the animated picture when it is time; it is called at every simulation step."""
        if self._scene.time_s >= self._next_frame_s:
            self._next_frame_s = self._scene.time_s + FRAME_EVERY_S
            # Shadows take as long as all the rest, and twenty frames a minute cost more than the physics.
            frame = self._picture(shadow=False)
            self._frames.append(frame.quantize(64, dither=Image.Dither.NONE))

    def save_picture(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._picture().save(path)

    def save_animation(self, path: Path) -> None:
        """All frames so far, as an animated GIF; nothing if there are none."""
        if self._frames:
            first, *rest = self._frames
            first.save(path, save_all=True, append_images=rest, duration=FRAME_SHOWN_MS, loop=0)

    def _picture(self, *, shadow: bool = True) -> Image.Image:
        picture = photograph(self._scene, self._pose, PICTURE_SIZE, shadow=shadow)
        if self._close_up is not None:
            # In a corner of the picture it would sooner or later hide the robot.
            close_up = photograph(self._scene, self._close_up(), CLOSE_UP_SIZE, shadow=shadow)
            left, height = picture.width + BORDER_PX, max(picture.height, close_up.height)
            both = Image.new("RGB", (left + close_up.width, height), "white")
            both.paste(picture, (0, 0))
            both.paste(close_up, (left, 0))
            return both
        return picture
