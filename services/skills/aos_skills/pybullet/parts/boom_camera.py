"""A depth camera on a boom ahead of a mobile base: it looks down at a table, past the hand."""

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pybullet

from aos_skills.pybullet.parts.scene import Scene, Vector

Colors = npt.NDArray[np.int16]
"""Red, green and blue of each pixel, 0 to 255."""

EYE_AHEAD_M, EYE_ABOVE_M, LOOKS_AHEAD_M = 0.7, 0.9, 0.8
FIELD_OF_VIEW_DEG = 25.0
SIZE = (240, 180)
NEAR_M, FAR_M = 0.1, 30.0
TOP_M = 0.002
"""Points this much below the highest point that is seen belong to its upper face."""
HIGHEST = 0.9
"""The highest point as a quantile: single pixels at an edge may be of anything."""


def top_seen(
    scene: Scene, base_place: Vector, table_top_m: float, is_it: Callable[[Colors], npt.NDArray[np.bool_]]
) -> Vector | None:
    """The middle of the upper face of what has the wanted color; None where nothing has it.

    `base_place` is x, y and yaw of the base, `is_it` says for each pixel whether it may be of the thing.
    """
    x, y, yaw = base_place
    cos, sin = math.cos(yaw), math.sin(yaw)
    eye = (x + EYE_AHEAD_M * cos, y + EYE_AHEAD_M * sin, table_top_m + EYE_ABOVE_M)
    at = (x + LOOKS_AHEAD_M * cos, y + LOOKS_AHEAD_M * sin, table_top_m)
    colors, points = _photograph(scene, eye, at)
    points_of_it = points[is_it(colors)]
    if len(points_of_it) == 0:
        return None
    upper = points_of_it[points_of_it[:, 2] > np.quantile(points_of_it[:, 2], HIGHEST) - TOP_M]
    middle = upper.mean(axis=0)
    return float(middle[0]), float(middle[1]), float(middle[2])


def _photograph(scene: Scene, eye: Vector, looks_at: Vector) -> tuple[Colors, npt.NDArray[np.float64]]:
    """The colors of a picture, and the place in the world, in metres, that each pixel shows."""
    width, height = SIZE
    _, _, pixels, depth, _ = scene.client.getCameraImage(
        width,
        height,
        scene.client.computeViewMatrix(eye, looks_at, (0, 0, 1)),
        scene.client.computeProjectionMatrixFOV(FIELD_OF_VIEW_DEG, width / height, NEAR_M, FAR_M),
        shadow=0,
        renderer=pybullet.ER_TINY_RENDERER,
    )
    colors = np.reshape(np.asarray(pixels, dtype=np.int16), (height, width, 4))[:, :, :3]
    buffer = np.reshape(np.asarray(depth, dtype=np.float64), (height, width, 1))
    ahead_m = FAR_M * NEAR_M / (FAR_M - (FAR_M - NEAR_M) * buffer)
    ahead = np.subtract(looks_at, eye)
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0, 0, 1))
    right = right / np.linalg.norm(right)
    half = math.tan(math.radians(FIELD_OF_VIEW_DEG) / 2)
    # The software renderer draws in a pixel what is at its lower left corner.
    across = (2 * np.arange(width) / width - 1)[None, :, None] * half * width / height
    up = (1 - 2 * (np.arange(height) + 1) / height)[:, None, None] * half
    return colors, np.asarray(eye) + ahead_m * (ahead + across * right + up * np.cross(right, ahead))
