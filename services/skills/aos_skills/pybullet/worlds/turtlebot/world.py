"""The TurtleBot in its arena: walls, obstacles, crates, and what it knows of them."""

import math
from collections import Counter
from typing import Any

import numpy as np
import pybullet

from aos_skills.pybullet.parts.route import FloorMap, Rectangle
from aos_skills.pybullet.parts.scene import Camera, Pose, Scene, Vector
from aos_skills.pybullet.parts.world import Faults, World
from aos_skills.pybullet.robots.turtlebot3 import TurtleBot3
from aos_skills.pybullet.worlds.turtlebot.file import TurtlebotFile

WALL_HALF_M = 0.03
HEIGHT_HALF_M = 0.12
ROBOT_RADIUS_M = 0.14
"""The radius of the Burger with its wheels, and a little more: estimates of places are never exact."""
VISITED_WITHIN_M = 0.1
_FLOOR, _WALL, _BLOCK = (0.80, 0.80, 0.76, 1), (0.55, 0.58, 0.62, 1), (0.25, 0.45, 0.35, 1)
_CRATE, _SPOT = (0.75, 0.45, 0.15, 1), (0.85, 0.15, 0.15, 1)


class Turtlebot(World):
    """Wheels, contacts and rays are simulated; the localisation's noise and lost reports are drawn."""

    def __init__(self, file: TurtlebotFile, seed: int) -> None:
        self.file = file
        self.scene = scene = Scene()
        self.faults = Faults(seed)
        scene.box((file.half_x + 1, file.half_y + 1, 0.05), (0, 0, -0.05), _FLOOR)
        walls = self._walls()
        mapped = [
            *walls,
            *((obstacle.x, obstacle.y, obstacle.half_x, obstacle.half_y) for obstacle in file.obstacles),
        ]
        for number, (x, y, half_x, half_y) in enumerate(mapped):
            color = _WALL if number < len(walls) else _BLOCK
            scene.box((half_x, half_y, HEIGHT_HALF_M), (x, y, HEIGHT_HALF_M), color)
        self.closed = [name for name, crate in file.crates.items() if self._stands(name, crate.probability)]
        for name in self.closed:
            crate = file.crates[name]
            scene.box((crate.half, crate.half, HEIGHT_HALF_M), (crate.x, crate.y, HEIGHT_HALF_M), _CRATE)
        self._spots()
        bounds = (0.0, 0.0, file.half_x, file.half_y)
        self.floor_map = FloorMap(bounds, mapped, ROBOT_RADIUS_M)
        place = (file.robot.x, file.robot.y, file.robot.yaw)
        noise = file.faults
        self.robot = TurtleBot3(scene, place, self.faults.noise, noise.place_noise_m, noise.yaw_noise_rad)
        self.visits: list[str] = []
        """Places in the order in which the robot came to stand there."""
        self.way_m = 0.0
        self._last_place = self.robot.true_place
        self.camera = Camera(scene, Pose((0.0, -1.4 * file.half_y, 2.0 * file.half_y), (0.0, -0.1, 0.0)))
        scene.watchers.append(self._count_way)

    def stop(self) -> None:
        self.robot.stop()
        at = self.robot.true_place
        for name, place in self.file.places.items():
            is_there = math.dist(at[:2], (place.x, place.y)) < VISITED_WITHIN_M
            if is_there and self.visits[-1:] != [name]:
                self.visits.append(name)

    def sensors(self) -> dict[str, dict[str, Any]]:
        x, y, yaw = self.robot.place
        ranges = np.round(self.robot.ranges_m(), 3).tolist()
        return {"/pose": {"x": x, "y": y, "yaw": yaw}, "/scan": {"ranges": ranges}}

    def truth(self) -> dict[str, Any]:
        return {
            "robot": [round(value, 3) for value in self.robot.true_place],
            "believed": [round(value, 3) for value in self.robot.place],
            "visits": list(self.visits),
            "stood": dict(sorted(Counter(self.visits).items())),
            "repeated": [name for name, times in sorted(Counter(self.visits).items()) if times > 1],
            "closed": self.closed,
            "missed": [name for name in self.file.places if name not in {*self.visits, *self.closed}],
            "way_m": round(self.way_m, 3),
        }

    def _stands(self, name: str, probability: float) -> bool:
        return self.faults.draw(f"a crate at {name}", probability)

    def _walls(self) -> list[Rectangle]:
        half_x, half_y = self.file.half_x, self.file.half_y
        beside_x, beside_y = half_x + WALL_HALF_M, half_y + WALL_HALF_M
        return [
            (beside_x, 0.0, WALL_HALF_M, beside_y),
            (-beside_x, 0.0, WALL_HALF_M, beside_y),
            (0.0, beside_y, beside_x, WALL_HALF_M),
            (0.0, -beside_y, beside_x, WALL_HALF_M),
        ]

    def _spots(self) -> None:
        """Painted on the floor, where the places are: nothing to bump into."""
        client = self.scene.client
        spot = client.createVisualShape(pybullet.GEOM_CYLINDER, radius=0.09, length=0.002, rgbaColor=_SPOT)
        for place in self.file.places.values():
            client.createMultiBody(0, -1, spot, (place.x, place.y, 0.002))

    def _count_way(self) -> None:
        at: Vector = self.robot.true_place
        if math.dist(at[:2], self._last_place[:2]) > 0.01:
            self.way_m += math.dist(at[:2], self._last_place[:2])
            self._last_place = at
