"""Pictures of the room, by the software renderer: no screen and no GPU needed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pybullet
from PIL import Image, ImageOps

from aos_skills.pybullet.robot import Robot
from aos_skills.pybullet.scene import Scene

__all__ = ["Camera"]

PICTURE_SIZE = (480, 360)
CLOSE_UP_SIZE = (200, 150)
FRAME_EVERY_S = 1.5
FRAME_SHOWN_MS = 200
FIELD_OF_VIEW_DEG = 50
EYE_M = (4.6, -5.6, 4.0)
LOOKS_AT_M = (1.7, 0.0, 0.3)
CLOSE_EYE_M = (1.1, -0.9, 0.7)
"""Of the close-up, from the hand."""
SUN = (3.0, -4.0, 7.0)
BORDER_PX = 2

Vector = tuple[float, float, float]


class Camera:
    """Looks into the room from its open side, with a close-up of the hand in the corner."""

    def __init__(self, scene: Scene, robot: Robot) -> None:
        self._scene = scene
        self._robot = robot
        self._frames: list[Image.Image] = []
        self._next_frame_s = 0.0

    def watch(self) -> None:
        """Called at every simulation step; takes a frame for the animated picture when it is time."""
        if self._scene.time_s >= self._next_frame_s:
            self._next_frame_s = self._scene.time_s + FRAME_EVERY_S
            self._frames.append(self._picture().quantize(64, dither=Image.Dither.NONE))

    def save_picture(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._picture().save(path)

    def save_animation(self, path: Path) -> None:
        """All frames so far, as an animated GIF; nothing if there are none."""
        if self._frames:
            first, *rest = self._frames
            first.save(path, save_all=True, append_images=rest, duration=FRAME_SHOWN_MS, loop=0)

    def _picture(self) -> Image.Image:
        hand = self._robot.tip_place()
        close_eye = (hand[0] + CLOSE_EYE_M[0], hand[1] + CLOSE_EYE_M[1], hand[2] + CLOSE_EYE_M[2])
        picture = self._seen(EYE_M, LOOKS_AT_M, PICTURE_SIZE)
        close_up = ImageOps.expand(self._seen(close_eye, hand, CLOSE_UP_SIZE), BORDER_PX, "white")
        picture.paste(close_up, (0, 0))
        return picture

    def _seen(self, eye: Vector, target: Vector, size: tuple[int, int]) -> Image.Image:
        client = self._scene.client
        width, height = size
        _, _, pixels, _, _ = client.getCameraImage(
            width,
            height,
            client.computeViewMatrix(eye, target, (0, 0, 1)),
            client.computeProjectionMatrixFOV(FIELD_OF_VIEW_DEG, width / height, 0.1, 30),
            shadow=1,
            lightDirection=SUN,
            renderer=pybullet.ER_TINY_RENDERER,
        )
        rgba = np.reshape(np.asarray(pixels, dtype=np.uint8), (height, width, 4))
        return Image.fromarray(rgba[:, :, :3])
