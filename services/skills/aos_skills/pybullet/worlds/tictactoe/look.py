"""Look: wait until the other one has drawn, take a picture, and read the board from it."""

from typing import Any

from aos_skills.pybullet.worlds.tictactoe.reading import board_in
from aos_skills.pybullet.worlds.tictactoe.world import TicTacToe


def look(world: TicTacToe, fields: dict[str, Any]) -> dict[str, Any]:
    """Takes nothing; `board` is nine characters, row by row. Empty if there is no board in the picture."""
    if not world.is_robots_turn and not world.is_over:
        world.let_other_draw()
    board = board_in(world.picture())
    return {"board": board or "", "success": board is not None}
