"""The board on the table, and the ink on it."""

import itertools
import math
import random

import pybullet

from aos_skills.pybullet.parts.scene import Color, Scene, Vector

CENTRE_M = (0.5, 0.0)
CELL_M = 0.08
TOP_M = 0.02
"""The height of the board above the robot's foot."""
SIDE_HALF_M = 0.15
LINE_HALF_M = 0.0025
INK_HALF_M = 0.003
INK_ABOVE_M = 0.001
INK_EVERY_M = 0.006
RADIUS_M = 0.025
_WHITE, _BLACK, _TABLE = (0.95, 0.95, 0.93, 1), (0.08, 0.08, 0.08, 1), (0.55, 0.42, 0.30, 1)
BLUE, RED = (0.08, 0.12, 0.55, 1), (0.65, 0.08, 0.08, 1)


def cell_centre(cell: int) -> tuple[float, float]:
    """Returns the centre of cell 0 to 8, row by row as the camera sees them: rows run away from the robot."""
    row, column = divmod(cell, 3)
    return CENTRE_M[0] + (row - 1) * CELL_M, CENTRE_M[1] + (column - 1) * CELL_M


def circle(cell: int) -> list[Vector]:
    """The way of a pen that draws a circle in a cell."""
    x, y = cell_centre(cell)
    angles = [2 * math.pi * step / 40 for step in range(42)]
    return [(x + RADIUS_M * math.cos(angle), y + RADIUS_M * math.sin(angle), TOP_M) for angle in angles]


class Board:
    """White, with a black rim and black lines; ink lies a millimetre above it, and nothing bumps into it."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        scene.box((0.6, 0.6, 0.02), (0.4, 0.0, -0.021), _TABLE)
        self.body = scene.box((SIDE_HALF_M, SIDE_HALF_M, TOP_M / 2), (*CENTRE_M, TOP_M / 2), _WHITE)
        x, y = CENTRE_M
        for side in (-1, 1):
            self._line((x + side * SIDE_HALF_M, y), (LINE_HALF_M * 2, SIDE_HALF_M), 0.0, _BLACK)
            self._line((x, y + side * SIDE_HALF_M), (SIDE_HALF_M, LINE_HALF_M * 2), 0.0, _BLACK)
            self._line((x + side * CELL_M / 2, y), (LINE_HALF_M, 1.5 * CELL_M), 0.0, _BLACK)
            self._line((x, y + side * CELL_M / 2), (1.5 * CELL_M, LINE_HALF_M), 0.0, _BLACK)
        self._pen_at: tuple[float, float] | None = None

    def ink(self, point: tuple[float, float]) -> None:
        """The pen touches the board there: draws on from where it touched before, unless that is far."""
        last = self._pen_at
        if last is None or math.dist(last, point) > 3 * INK_EVERY_M:
            self._pen_at = point
        elif math.dist(last, point) >= INK_EVERY_M:
            middle = ((last[0] + point[0]) / 2, (last[1] + point[1]) / 2)
            half = (math.dist(last, point) / 2 + INK_HALF_M / 2, INK_HALF_M)
            self._line(middle, half, math.atan2(point[1] - last[1], point[0] - last[0]), BLUE)
            self._pen_at = point

    def lift(self) -> None:
        """The pen no longer touches."""
        self._pen_at = None

    def cross(self, cell: int, hand: random.Random) -> None:
        """A person's cross, never quite straight and never quite in the middle."""
        self._strokes(cell, hand, [((-1, -1), (1, 1)), ((-1, 1), (1, -1))], RED)

    def circle(self, cell: int, hand: random.Random) -> None:
        """A circle that was drawn before the game."""
        corners = [(math.cos(a * math.pi / 10), math.sin(a * math.pi / 10)) for a in range(21)]
        self._strokes(cell, hand, list(itertools.pairwise(corners)), BLUE)

    def _strokes(
        self,
        cell: int,
        hand: random.Random,
        strokes: list[tuple[tuple[float, float], tuple[float, float]]],
        color: Color,
    ) -> None:
        x, y = cell_centre(cell)
        x, y = x + hand.gauss(0, 0.004), y + hand.gauss(0, 0.004)
        size, turn = RADIUS_M * hand.uniform(0.75, 1.1), hand.gauss(0, 0.12)
        for stroke in strokes:
            (a, b), (c, d) = (
                (
                    x + size * (u * math.cos(turn) - v * math.sin(turn)),
                    y + size * (u * math.sin(turn) + v * math.cos(turn)),
                )
                for u, v in stroke
            )
            half = (math.dist((a, b), (c, d)) / 2 + INK_HALF_M / 2, INK_HALF_M)
            self._line(((a + c) / 2, (b + d) / 2), half, math.atan2(d - b, c - a), color)

    def _line(self, at: tuple[float, float], half: tuple[float, float], yaw: float, color: Color) -> None:
        client = self._scene.client
        shape = client.createVisualShape(
            pybullet.GEOM_BOX, halfExtents=(*half, INK_ABOVE_M / 2), rgbaColor=color
        )
        turned = client.getQuaternionFromEuler((0, 0, yaw))
        client.createMultiBody(0, -1, shape, (*at, TOP_M + INK_ABOVE_M / 2), turned)
