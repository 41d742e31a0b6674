"""A Panda plays tic-tac-toe on a board that it draws on and looks at, against a person."""

from aos_skills.pybullet.parts.world import WorldKind
from aos_skills.pybullet.worlds.tictactoe.file import TicTacToeFile
from aos_skills.pybullet.worlds.tictactoe.skills import draw, look
from aos_skills.pybullet.worlds.tictactoe.world import TicTacToe

__all__ = ["KIND"]

KIND = WorldKind(TicTacToeFile, TicTacToe, {"/draw": draw, "/look": look})
