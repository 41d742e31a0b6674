"""Look: a picture of the table in front of the robot, and whether there is something red on it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from aos_skills.pybullet.parts.camera import photograph
from aos_skills.pybullet.worlds.cleanlab.world import AHEAD_M, TABLE_TOP_M, CleanLab

__all__ = ["look"]

LOOKING_S = 0.5
EYE_AHEAD_M, EYE_ABOVE_M = 0.7, 0.9
PICTURE_SIZE = (96, 72)
MIN_RED = 0.005
"""Share of the picture's pixels."""


def look(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing; `is_there` says whether the robot sees a cup in front of it."""
    world.scene.wait(LOOKING_S)
    is_there = _sees_cup(world)
    if is_there:
        return {"is_there": not world.faults.draw("glare", world.file.faults.glare)}
    return {"is_there": world.faults.draw("a ghost", world.file.faults.ghost)}


def _sees_cup(world: CleanLab) -> bool:
    """By a camera on a boom ahead of the base, which looks down at the table and past the hand."""
    x, y, yaw = world.robot.base.place
    cos, sin = math.cos(yaw), math.sin(yaw)
    eye = (x + EYE_AHEAD_M * cos, y + EYE_AHEAD_M * sin, TABLE_TOP_M + EYE_ABOVE_M)
    at = (x + AHEAD_M * cos, y + AHEAD_M * sin, TABLE_TOP_M)
    picture = photograph(world.scene, eye, at, PICTURE_SIZE, field_of_view_deg=25, shadow=False)
    red, green, blue = np.moveaxis(np.asarray(picture, dtype=np.int16), -1, 0)
    return bool(np.mean((red > 2 * green) & (red > 2 * blue) & (red > 60)) > MIN_RED)
