"""What the robot sees of the table in front of it: something red, and where that is."""

from __future__ import annotations

import math

import numpy as np

from aos_skills.pybullet.parts.camera import photograph, place_of_pixel
from aos_skills.pybullet.worlds.cleanlab.world import AHEAD_M, CUP_HEIGHT_M, TABLE_TOP_M, CleanLab

__all__ = ["place_of_cup"]

EYE_AHEAD_M, EYE_ABOVE_M = 0.7, 0.9
FIELD_OF_VIEW_DEG = 25.0
PICTURE_SIZE = (96, 72)
MIN_RED = 0.005
"""Share of the picture's pixels; less is no cup."""
SEEN_AT_M = TABLE_TOP_M + 0.75 * CUP_HEIGHT_M
"""The height of the middle of what is seen of a standing cup: its upper face, and some of its side."""


def place_of_cup(world: CleanLab) -> tuple[float, float] | None:
    """The middle of what is red in a picture of the table, in metres; None where too little is.

    The camera is on a boom ahead of the base, and looks down at the table, past the hand.
    """
    x, y, yaw = world.robot.base.place
    cos, sin = math.cos(yaw), math.sin(yaw)
    eye = (x + EYE_AHEAD_M * cos, y + EYE_AHEAD_M * sin, TABLE_TOP_M + EYE_ABOVE_M)
    at = (x + AHEAD_M * cos, y + AHEAD_M * sin, TABLE_TOP_M)
    picture = photograph(
        world.scene, eye, at, PICTURE_SIZE, field_of_view_deg=FIELD_OF_VIEW_DEG, shadow=False
    )
    red, green, blue = np.moveaxis(np.asarray(picture, dtype=np.int16), -1, 0)
    is_red = (red > 2 * green) & (red > 2 * blue) & (red > 60)
    if np.mean(is_red) <= MIN_RED:
        return None
    row, column = np.argwhere(is_red).mean(axis=0)
    pixel = (float(column), float(row))
    return place_of_pixel(eye, at, PICTURE_SIZE, FIELD_OF_VIEW_DEG, pixel, SEEN_AT_M)
