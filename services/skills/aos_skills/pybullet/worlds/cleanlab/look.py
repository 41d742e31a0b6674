"""Look: a picture of the table in front of the robot, and whether there is something red on it."""

from typing import Any

from aos_skills.pybullet.worlds.cleanlab.seeing import place_of_cup
from aos_skills.pybullet.worlds.cleanlab.world import CleanLab

LOOKING_S = 0.5


def look(world: CleanLab, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing; `is_there` says whether the robot sees a cup in front of it."""
    world.scene.wait(LOOKING_S)
    if place_of_cup(world) is not None:
        return {"is_there": not world.faults.draw("glare", world.file.faults.glare)}
    return {"is_there": world.faults.draw("a ghost", world.file.faults.ghost)}
