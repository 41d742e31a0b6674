"""Draw: a circle in a cell, with the pen on the board."""

from __future__ import annotations

from typing import Any

from aos_skills.pybullet.worlds.tictactoe.board import circle
from aos_skills.pybullet.worlds.tictactoe.rules import marked
from aos_skills.pybullet.worlds.tictactoe.world import TicTacToe

__all__ = ["draw"]

CENTRE = 4
PRESS_M = 0.002
"""The pen is led this far below the surface, so that it stays on it."""
DRY_ABOVE_M = 0.006


def draw(world: TicTacToe, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes `cell`, 0 to 8; `success` says whether the pen has left a circle. The turn passes anyway."""
    cell = int(fields["cell"])
    if not 0 <= cell <= 8:
        raise ValueError(f"there is no cell {cell}")
    is_dry = cell == CENTRE and world.faults.draw("the pen does not write", world.file.faults.dry_centre)
    height = DRY_ABOVE_M if is_dry else -PRESS_M
    way = [(x, y, z + height) for x, y, z in circle(cell)]
    inked = world.write(way)
    world.tuck()
    if inked and world.marks[cell] == "?":
        world.marks = marked(world.marks, cell, "O")
    world.is_robots_turn = False
    return {"success": inked}
