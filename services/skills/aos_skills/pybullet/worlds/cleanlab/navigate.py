"""Navigate: along the aisle in the middle, and up to a station or a bin."""

import math
from typing import Any

from aos_skills.pybullet.worlds.cleanlab.world import CleanLab

AISLE_Y_M = 0.0


def navigate(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes `x` and `y` in metres and `yaw` in radians; `success` says whether it arrived."""
    base = world.robot.base
    x, y, yaw = float(fields["x"]), float(fields["y"]), float(fields["yaw"])
    at_x, at_y, at_yaw = base.place
    if math.dist((at_x, at_y), (x, y)) < 0.05:
        return {"success": base.drive_to(x, y, yaw)}
    # It backs out of where it stands, without turning beside the table.
    in_aisle = base.creep(-abs(at_y - AISLE_Y_M)) if abs(at_y - AISLE_Y_M) > 0.05 else True
    along = abs(x - at_x) < 0.05 or base.drive_to(x, AISLE_Y_M, at_yaw)
    return {"success": in_aisle and along and base.drive_to(x, y, yaw)}
