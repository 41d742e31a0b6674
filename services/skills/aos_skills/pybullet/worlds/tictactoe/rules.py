"""The game: boards as nine characters, row by row, `O` of the robot, `X` of the person, `?` for nothing."""

from __future__ import annotations

from functools import cache

__all__ = ["EMPTY_BOARD", "best_moves", "empty_cells", "is_over", "marked", "winner"]

EMPTY_BOARD = "?" * 9
ROWS = ((0, 1, 2), (3, 4, 5), (6, 7, 8), (0, 3, 6), (1, 4, 7), (2, 5, 8), (0, 4, 8), (2, 4, 6))


def empty_cells(board: str) -> list[int]:
    """Their numbers, from 0."""
    return [cell for cell, mark in enumerate(board) if mark == "?"]


def marked(board: str, cell: int, mark: str) -> str:
    """The board with one more mark."""
    return board[:cell] + mark + board[cell + 1 :]


def winner(board: str) -> str | None:
    """Whose mark fills a row."""
    marks = (board[a] for a, b, c in ROWS if board[a] == board[b] == board[c] != "?")
    return next(marks, None)


def is_over(board: str) -> bool:
    return winner(board) is not None or "?" not in board


def best_moves(board: str, mark: str) -> list[int]:
    """The cells from which a perfect player of `mark` gets the most against another one."""
    worth = {cell: -_worth(marked(board, cell, mark), _other(mark)) for cell in empty_cells(board)}
    return [cell for cell, value in worth.items() if value == max(worth.values())]


@cache
def _worth(board: str, mark: str) -> int:
    """What perfect play brings to who has the turn: 1, 0 or -1."""
    if winner(board) is not None:
        return -1  # The one who drew last has won.
    cells = empty_cells(board)
    return max((-_worth(marked(board, cell, mark), _other(mark)) for cell in cells), default=0)


def _other(mark: str) -> str:
    return "X" if mark == "O" else "O"
