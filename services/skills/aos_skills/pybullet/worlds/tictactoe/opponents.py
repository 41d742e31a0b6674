"""The players against the robot: a random one, a perfect one, or a person at a terminal."""

import random
from collections.abc import Callable

from aos_skills.pybullet.parts.scene import Scene
from aos_skills.pybullet.worlds.tictactoe.file import TicTacToeFile
from aos_skills.pybullet.worlds.tictactoe.person import PersonAtTerminal
from aos_skills.pybullet.worlds.tictactoe.rules import best_moves, empty_cells


def opponent(file: TicTacToeFile, chance: random.Random, scene: Scene) -> Callable[[str], int]:
    """Gives the cell of the next cross on a board."""
    match file.opponent:
        case "random":
            return lambda board: chance.choice(empty_cells(board))
        case "perfect":
            return lambda board: chance.choice(best_moves(board, "X", file.rules))
        case "person":
            return PersonAtTerminal(file.port, scene)
