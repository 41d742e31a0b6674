"""Ways on a floor map: A* over a grid whose cells cost more near obstacles, then pulled straight."""

from __future__ import annotations

import math
from collections.abc import Sequence

import networkx as nx
import numpy as np
import numpy.typing as npt

CELL_M = 0.05
NEAR_M = 0.12
"""The distance from the forbidden border within which cells cost up to NEAR_COST times as much more."""
NEAR_COST = 3.0

Point = tuple[float, float]
Rectangle = tuple[float, float, float, float]
"""An obstacle by its centre and half its sides, along x and y, in metres."""
Floats = npt.NDArray[np.float64]
Cell = tuple[int, int]


class FloorMap:
    """The known floor within `bounds`, for a round robot of `radius_m` whose middle stays inside.

    Points that were seen and are on no map (`add`) forbid as much as mapped obstacles do.
    """

    def __init__(self, bounds: Rectangle, obstacles: Sequence[Rectangle], radius_m: float) -> None:
        x, y, half_x, half_y = bounds
        self._corner = (x - half_x, y - half_y)
        self._shape = (round(2 * half_x / CELL_M) + 1, round(2 * half_y / CELL_M) + 1)
        self._obstacles = list(obstacles)
        self._radius_m = radius_m
        columns, rows = np.indices(self._shape)
        self._cells = np.stack([columns, rows], axis=-1) * CELL_M + np.array(self._corner)
        self._mapped = self.distance(self._cells)
        self._clearance = self._mapped.copy()
        """The distance of each cell's middle from the nearest obstacle, in metres."""

    def distance(self, points: Floats) -> Floats:
        """Returns the distances of points (x and y in the last axis) from the nearest mapped obstacle."""
        nearest = np.full(points.shape[:-1], np.inf)
        for x, y, half_x, half_y in self._obstacles:
            beside = np.abs(points - np.array([x, y])) - np.array([half_x, half_y])
            nearest = np.minimum(nearest, np.hypot(*np.moveaxis(np.maximum(beside, 0.0), -1, 0)))
        return nearest

    def add(self, points: Floats) -> None:
        """Takes in points where something stands that is not on the map."""
        for point in points:
            self._clearance = np.minimum(self._clearance, np.hypot(*np.moveaxis(self._cells - point, -1, 0)))

    def forget(self) -> None:
        """Forgets all points that are not mapped."""
        self._clearance = self._mapped.copy()

    def is_free(self, points: Floats) -> bool:
        """Returns whether the robot's middle may be at all of the points."""
        cells = np.rint((points - np.array(self._corner)) / CELL_M).astype(int)
        is_inside = (cells >= 0).all() and (cells < np.array(self._shape)).all()
        return bool(is_inside and (self._clearance[cells[:, 0], cells[:, 1]] >= self._radius_m).all())

    def way(self, start: Point, goal: Point) -> list[Point] | None:
        """Corners of a short way from start to goal, both included; None if there is none.

        The start may be too near to an obstacle, for the robot has to leave from where it is.
        """
        if not self.is_free(np.array([goal])):
            return None
        begin, end = self._cell(start), self._cell(goal)
        graph = self._graph(begin)

        def straight(one: Cell, other: Cell) -> float:
            return math.dist(one, other) * CELL_M

        try:
            cells = nx.astar_path(graph, begin, end, heuristic=straight)
        except (nx.NetworkXNoPath, nx.NodeNotFound):
            return None
        left, low = self._corner
        between = [(left + column * CELL_M, low + row * CELL_M) for column, row in cells[1:-1]]
        return self._pulled([start, *between, goal])

    def _cell(self, point: Point) -> Cell:
        column, row = (round((at - corner) / CELL_M) for at, corner in zip(point, self._corner, strict=True))
        width, height = self._shape
        return min(max(column, 0), width - 1), min(max(row, 0), height - 1)

    def _graph(self, begin: Cell) -> nx.Graph[Cell]:
        """Free cells and their eight neighbours."""
        room = self._clearance - self._radius_m
        is_free = room >= 0
        is_free[begin] = True
        cost = 1 + NEAR_COST * np.clip(1 - room / NEAR_M, 0, 1)
        graph: nx.Graph[Cell] = nx.Graph()
        graph.add_nodes_from(zip(*np.nonzero(is_free), strict=True))
        for step in ((1, 0), (0, 1), (1, 1), (1, -1)):
            here, there = _shifted(is_free, step)
            are_free = is_free[here] & is_free[there]
            ways = (cost[here] + cost[there])[are_free] * (math.hypot(*step) * CELL_M / 2)
            both = np.argwhere(are_free)
            first = both + np.array([part.start for part in here])
            second = both + np.array([part.start for part in there])
            graph.add_weighted_edges_from(
                ((a, b), (c, d), way)
                for (a, b), (c, d), way in zip(first.tolist(), second.tolist(), ways.tolist(), strict=True)
            )
        return graph

    def _pulled(self, points: list[Point]) -> list[Point]:
        """The same way with fewer corners: each as far on as a straight, free line leads."""
        corners, here = [points[0]], 0
        while here < len(points) - 1:
            farther = range(len(points) - 1, here + 1, -1)
            here = next((far for far in farther if self._sees(points[here], points[far])), here + 1)
            corners.append(points[here])
        return corners

    def _sees(self, start: Point, end: Point) -> bool:
        steps = max(math.ceil(math.dist(start, end) / (CELL_M / 2)), 1)
        shares = np.linspace(0, 1, steps + 1)[:, None]
        line = np.array(start) + shares * (np.array(end) - np.array(start))
        return self.is_free(line[1:])


def _shifted(
    grid: npt.NDArray[np.bool_], step: tuple[int, int]
) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """The parts of a grid that lie over each other when it is moved by a step."""
    width, height = grid.shape
    x, y = step
    here = (slice(0, width - x), slice(max(0, -y), height - max(0, y)))
    there = (slice(x, width), slice(max(0, y), height - max(0, -y)))
    return here, there
