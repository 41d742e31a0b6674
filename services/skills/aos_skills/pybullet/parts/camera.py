"""Pictures of a scene, by the software renderer: no screen and no GPU needed."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pybullet
from PIL import Image

from aos_skills.pybullet.parts.scene import Scene, Vector

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
