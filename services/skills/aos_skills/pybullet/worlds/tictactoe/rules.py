"""The game: boards as nine characters, row by row, `O` of the robot, `X` of the person, `?` for nothing.

By the rules `row`, three in a row win. By the rules `corners` the board is filled, and whoever has marked a
corner and a cell beside it has a point for each such pair; more points win.
"""

from functools import cache
from typing import Literal

Rules = Literal["row", "corners"]

EMPTY_BOARD = "?" * 9
ROWS = ((0, 1, 2), (3, 4, 5), (6, 7, 8), (0, 3, 6), (1, 4, 7), (2, 5, 8), (0, 4, 8), (2, 4, 6))
PAIRS = ((0, 1), (0, 3), (2, 1), (2, 5), (6, 3), (6, 7), (8, 5), (8, 7))


def empty_cells(board: str) -> list[int]:
    """Their numbers, from 0."""
    return [cell for cell, mark in enumerate(board) if mark == "?"]


def marked(board: str, cell: int, mark: str) -> str:
    return board[:cell] + mark + board[cell + 1 :]


def winner(board: str, rules: Rules = "row") -> str | None:
    """Returns who has won; None while nobody has."""
    if rules == "corners":
        lead = _points(board, "O") - _points(board, "X") if "?" not in board else 0
        return "O" if lead > 0 else "X" if lead < 0 else None
    marks = (board[a] for a, b, c in ROWS if board[a] == board[b] == board[c] != "?")
    return next(marks, None)


def is_over(board: str, rules: Rules = "row") -> bool:
    return "?" not in board or winner(board, rules) is not None


def best_moves(board: str, mark: str, rules: Rules = "row") -> list[int]:
    """The cells from which a perfect player of `mark` gets the most against another one."""
    worth = {cell: -_worth(marked(board, cell, mark), _other(mark), rules) for cell in empty_cells(board)}
    return [cell for cell, value in worth.items() if value == max(worth.values())]


@cache
def _worth(board: str, mark: str, rules: Rules) -> int:
    """Returns what perfect play brings to who has the turn: 1, 0 or -1."""
    if is_over(board, rules):
        return {mark: 1, _other(mark): -1, None: 0}[winner(board, rules)]
    return max(-_worth(marked(board, cell, mark), _other(mark), rules) for cell in empty_cells(board))


def _points(board: str, mark: str) -> int:
    return sum(board[corner] == board[beside] == mark for corner, beside in PAIRS)


def _other(mark: str) -> str:
    return "X" if mark == "O" else "O"
