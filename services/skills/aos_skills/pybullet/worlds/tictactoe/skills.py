"""The skills of the player: each takes the fields of its call, and answers with the result."""

from typing import Any

from aos_skills.pybullet.worlds.tictactoe.board import circle
from aos_skills.pybullet.worlds.tictactoe.reading import board_in
from aos_skills.pybullet.worlds.tictactoe.rules import marked
from aos_skills.pybullet.worlds.tictactoe.world import TicTacToe


def look(world: TicTacToe, fields: dict[str, Any]) -> dict[str, Any]:
    """Waits until the other one has drawn, takes a picture, and reads the board from it; takes nothing.

    `board` is nine characters, row by row. Empty if there is no board in the picture.
    """
    if not world.is_robots_turn and not world.is_over:
        world.let_other_draw()
    board = board_in(world.picture())
    return {"board": board or "", "success": board is not None}


CENTRE = 4
PRESS_M = 0.002
"""The pen is led this far below the surface, so that it stays on it."""
DRY_ABOVE_M = 0.006


def draw(world: TicTacToe, fields: dict[str, Any]) -> dict[str, Any]:
    """Draws a circle in a cell, with the pen on the board.

    Takes `cell`, 0 to 8; `success` says whether the robot sees a circle there. The turn passes anyway.
    """
    cell = int(fields["cell"])
    if not 0 <= cell <= 8:
        raise ValueError(f"there is no cell {cell}")
    is_dry = cell == CENTRE and world.faults.draw("the pen does not write", world.file.faults.dry_centre)
    height = DRY_ABOVE_M if is_dry else -PRESS_M
    way = [(x, y, z + height) for x, y, z in circle(cell)]
    has_left_ink = world.write(way)
    world.tuck()
    if has_left_ink and world.marks[cell] == "?":
        world.marks = marked(world.marks, cell, "O")
        world.circled.append(cell)
    world.is_robots_turn = False
    world.tell_end()
    board = board_in(world.picture())
    return {"success": board is not None and board[cell] == "O"}
