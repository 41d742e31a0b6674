"""Sense: stand still while the sensors publish. What that means is said by the abstraction mappings."""

from typing import Any

from aos_skills.pybullet.worlds.armadillo.world import Armadillo

SENSING_S = 0.5


def sense(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing, and answers with what the sensors say at the end."""
    world.scene.wait(SENSING_S)
    return {name: value for readings in world.sensors().values() for name, value in readings.items()}
