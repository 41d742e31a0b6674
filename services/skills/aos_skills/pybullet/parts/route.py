"""Ways on a floor map: A* over a grid whose cells cost more near obstacles, then pulled straight.

Two wheels follow one: they turn towards a point a little ahead on it, and drive.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from enum import Enum, auto

import networkx as nx
import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.scene import Scene
from aos_skills.pybullet.robots.turtlebot3.robot import DifferentialDrive

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


EVERY_STEPS = 12
AHEAD_M = 0.15
ARRIVED_M = 0.04
MAX_SPEED_M_S = 0.22
MAX_TURN_RAD_S = 2.0
TURN_FIRST_RAD = 0.5
"""A robot that looks further away from its way than this turns before it drives."""
STUCK_AFTER_S = 4.0
STUCK_WITHIN_M = 0.02


class Following(Enum):
    """The ways in which following a way ends."""

    ARRIVED = auto()
    BLOCKED = auto()
    """`is_free` said so of what was left of the way."""
    STUCK = auto()


def follow(
    scene: Scene, drive: DifferentialDrive, way: list[Point], is_free: Callable[[list[Point]], bool]
) -> Following:
    """Drives along a way until its end; `is_free` is asked twenty times a second about what is left of it."""
    corners = _dense(way)
    progress, tried_from, since_s = 0, drive.odometry[:2], scene.time_s
    while True:
        x, y, yaw = drive.odometry
        near = corners[progress : progress + 20]
        progress += min(range(len(near)), key=lambda index: math.dist(near[index], (x, y)))
        ahead = corners[progress:]
        if math.dist((x, y), corners[-1]) < ARRIVED_M:
            ending = Following.ARRIVED
            break
        if not is_free(ahead):
            ending = Following.BLOCKED
            break
        if math.dist((x, y), tried_from) > STUCK_WITHIN_M:
            tried_from, since_s = (x, y), scene.time_s
        elif scene.time_s - since_s > STUCK_AFTER_S:
            ending = Following.STUCK
            break
        target = next((point for point in ahead if math.dist(point, (x, y)) > AHEAD_M), ahead[-1])
        error = math.remainder(math.atan2(target[1] - y, target[0] - x) - yaw, 2 * math.pi)
        turn = max(-MAX_TURN_RAD_S, min(MAX_TURN_RAD_S, 3.0 * error))
        is_turning = abs(error) > TURN_FIRST_RAD
        speed = 0.0 if is_turning else min(MAX_SPEED_M_S, 1.0 * math.dist((x, y), corners[-1]) + 0.03)
        drive.command(speed * math.cos(error), turn)
        for _ in range(EVERY_STEPS):
            scene.step()
    drive.command(0.0, 0.0)
    scene.wait(0.5)
    return ending


def _dense(way: list[Point]) -> list[Point]:
    """The way as points 2 cm apart."""
    points: list[Point] = [way[0]]
    for start, end in itertools.pairwise(way):
        count = max(math.ceil(math.dist(start, end) / 0.02), 1)
        shares = [step / count for step in range(1, count + 1)]
        points += [(start[0] + s * (end[0] - start[0]), start[1] + s * (end[1] - start[1])) for s in shares]
    return points
