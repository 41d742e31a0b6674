"""Pictures of the room, by the software renderer: no screen and no GPU needed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pybullet
from PIL import Image

from aos_skills.pybullet.scene import Scene

__all__ = ["Camera"]

PICTURE_SIZE = (480, 360)
FRAME_SIZE = (320, 240)
FRAME_EVERY_S = 0.8
FRAME_SHOWN_MS = 120
EYE = (3.6, -4.6, 4.3)
LOOKS_AT = (1.55, 0.15, 0.35)
SUN = (3.0, -4.0, 7.0)


class Camera:
    """Looks into the room from the open side, and keeps the frames of an animated picture."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._frames: list[Image.Image] = []
        self._next_frame_s = 0.0

    def watch(self) -> None:
        """Called at every simulation step; takes a frame when it is time."""
        if self._scene.time_s >= self._next_frame_s:
            self._next_frame_s = self._scene.time_s + FRAME_EVERY_S
            frame = self._picture(FRAME_SIZE)
            self._frames.append(frame.quantize(64, dither=Image.Dither.NONE))

    def save_picture(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._picture(PICTURE_SIZE).save(path)

    def save_animation(self, path: Path) -> None:
        """All frames so far, as an animated GIF; nothing if there are none."""
        if self._frames:
            first, *rest = self._frames
            first.save(path, save_all=True, append_images=rest, duration=FRAME_SHOWN_MS, loop=0)

    def _picture(self, size: tuple[int, int]) -> Image.Image:
        client = self._scene.client
        width, height = size
        _, _, pixels, _, _ = client.getCameraImage(
            width,
            height,
            client.computeViewMatrix(EYE, LOOKS_AT, (0, 0, 1)),
            client.computeProjectionMatrixFOV(58, width / height, 0.1, 30),
            shadow=1,
            lightDirection=SUN,
            renderer=pybullet.ER_TINY_RENDERER,
        )
        return Image.fromarray(np.reshape(np.asarray(pixels, dtype=np.uint8), (height, width, 4))[:, :, :3])
