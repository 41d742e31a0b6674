"""The robot's sight of the table in front of it: something red, and where that is."""

import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.boom_camera import Colors, top_seen
from aos_skills.pybullet.worlds.cleanlab.world import TABLE_TOP_M, CleanLab

MIN_RED = 0.005
"""Share of the picture's pixels; less is no cup."""


def place_of_cup(world: CleanLab) -> tuple[float, float] | None:
    """The middle of what is red in a picture of the table, in metres; None where too little is."""
    top = top_seen(world.scene, world.robot.base.place, TABLE_TOP_M, _is_cup)
    return top[:2] if top is not None else None


def _is_cup(colors: Colors) -> npt.NDArray[np.bool_]:
    red, green, blue = np.moveaxis(colors, -1, 0)
    is_red: npt.NDArray[np.bool_] = (red > 2 * green) & (red > 2 * blue) & (red > 60)
    return is_red if np.mean(is_red) > MIN_RED else np.zeros_like(is_red)
