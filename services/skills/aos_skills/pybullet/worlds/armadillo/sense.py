"""Sense: stand still while the sensors publish. What that means is said by the abstraction mappings."""

from __future__ import annotations

from typing import Any

from aos_skills.pybullet.worlds.armadillo.world import Armadillo

__all__ = ["sense"]

SENSING_S = 0.5


def sense(world: Armadillo, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes and answers nothing."""
    world.scene.wait(SENSING_S)
    return {}
