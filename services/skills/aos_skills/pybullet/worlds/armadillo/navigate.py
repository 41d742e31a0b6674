"""Navigate: to a place in the room."""

import math
from typing import Any

from aos_skills.pybullet.worlds.armadillo.world import Armadillo

CROSSING = (0.0, 0.0)
"""All ways between the places lead over the middle of the room."""


def navigate(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes `x` and `y` in metres and `yaw` in radians; `success` says whether it arrived."""
    base = world.robot.base
    x, y, yaw = float(fields["x"]), float(fields["y"]), float(fields["yaw"])
    at_x, at_y, at_yaw = base.place
    if math.hypot(x - at_x, y - at_y) < 0.05:
        return {"success": base.drive_to(x, y, yaw)}
    has_crossed = base.drive_to(*CROSSING, at_yaw)
    return {"success": has_crossed and base.drive_to(x, y, yaw)}
