"""The laboratory: a station in front of each robot's place, bins at both ends, cups somewhere."""

import math
import random
from typing import Any

import numpy as np
import numpy.typing as npt

from aos_skills.pybullet.parts.boom_camera import Colors, top_seen
from aos_skills.pybullet.parts.room_file import Place
from aos_skills.pybullet.parts.scene import Camera, Pose, Scene
from aos_skills.pybullet.parts.world import Faults, World
from aos_skills.pybullet.robots.mobile_arm import MobileArm
from aos_skills.pybullet.worlds.cleanlab.file import CleanLabFile

AHEAD_M = 0.8
"""The distance of a cup, or of a bin's middle, from the middle of the robot that stands in front of it."""
TABLE_TOP_M = 0.5
TABLE_BEHIND_CUP_M = 0.17
TABLE_HALF_M = (0.3, 0.22)
BIN_TOP_M = 0.45
BIN_HALF_M = 0.2
BIN_WALL_HALF_M = 0.01
UPRIGHT = 0.9
"""The least cosine of a standing cup's tilt."""
BESIDE_M = 0.15
CUP_RADIUS_M, CUP_HEIGHT_M, CUP_MASS_KG = 0.032, 0.08, 0.08
_FLOOR, _TABLE, _BIN, _CUP = (
    (0.75, 0.77, 0.78, 1),
    (0.92, 0.92, 0.90, 1),
    (0.25, 0.4, 0.3, 1),
    (0.85, 0.1, 0.1, 1),
)


def ahead(place: Place, distance_m: float) -> tuple[float, float]:
    """The point so far in front of who stands at a place."""
    return place.x + distance_m * math.cos(place.yaw), place.y + distance_m * math.sin(place.yaw)


def filled_stations(file: CleanLabFile, seed: int) -> list[str]:
    """Draws the stations where the cups are at first: different ones of each group."""
    chance = random.Random(f"cups {seed}")
    return [name for group in file.groups for name in chance.sample(group.stations, group.cups)]


class CleanLab(World):
    """A lab with cups: what is seen is a picture, what is held is contact; glare, ghosts and reflections
    are drawn."""

    def __init__(self, file: CleanLabFile, seed: int) -> None:
        self.file = file
        self.scene = scene = Scene()
        self.faults = Faults(seed)
        scene.box((5, 4, 0.05), (0, 0, -0.05), _FLOOR)
        for place in file.stations.values():
            self._table(place)
        for place in file.bins.values():
            self._bin(place)
        self.cups = {name: self._cup(file.stations[name]) for name in filled_stations(file, seed)}
        """Bodies, by the station where each was at first."""
        self.robot = MobileArm(scene, (file.robot.x, file.robot.y, file.robot.yaw))
        self.camera = Camera(scene, Pose((0.0, -5.4, 4.2), (0.0, 0.9, 0.4)), self._close_up)

    @property
    def held_cup(self) -> str | None:
        """The truth, which the robot senses by its fingers."""
        return next((name for name, cup in self.cups.items() if self.robot.gripper.holds(cup)), None)

    def binned(self) -> list[str]:
        """The cups that lie in bins."""
        centres = [ahead(place, AHEAD_M) for place in self.file.bins.values()]
        places = {name: self.scene.place(cup) for name, cup in self.cups.items()}
        return [
            name
            for name, (x, y, z) in places.items()
            if z < BIN_TOP_M and any(max(abs(x - a), abs(y - b)) < BIN_HALF_M for a, b in centres)
        ]

    def _is_standing(self, cup: int) -> bool:
        """Returns whether the cup stands on a table and is not in the hand."""
        _, _, z = self.scene.place(cup)
        is_upright = z > TABLE_TOP_M and self.scene.uprightness(cup) > UPRIGHT
        return is_upright and not self.robot.gripper.holds(cup)

    def _at(self) -> str:
        """The station or the bin that the robot stands in front of, or nothing."""
        x, y, _ = self.robot.base.place
        places = {**self.file.stations, **self.file.bins}
        near = (name for name, place in places.items() if math.dist((x, y), (place.x, place.y)) < BESIDE_M)
        return next(near, "")

    def stop(self) -> None:
        self.robot.stop()

    def sensors(self) -> dict[str, dict[str, Any]]:
        left, right = self.robot.gripper.forces_n()
        gripper = {"gap_m": self.robot.gripper.gap_m, "left_force_n": left, "right_force_n": right}
        return {"/gripper": gripper, "/joints": {"positions": self.robot.arm.angles}}

    def truth(self) -> dict[str, Any]:
        return {
            "base": [round(value, 3) for value in self.robot.base.place],
            "cups": {name: [round(v, 3) for v in self.scene.place(cup)] for name, cup in self.cups.items()},
            "at": self._at(),
            "held": self.held_cup,
            "binned": self.binned(),
            "standing": [name for name, cup in self.cups.items() if self._is_standing(cup)],
        }

    def _table(self, place: Place) -> None:
        x, y = ahead(place, AHEAD_M + TABLE_BEHIND_CUP_M)
        half_x, half_y = TABLE_HALF_M
        across = place.yaw - math.pi / 2
        self.scene.box((half_x, half_y, 0.02), (x, y, TABLE_TOP_M - 0.02), _TABLE, yaw=across)
        self.scene.box((0.08, 0.08, TABLE_TOP_M / 2 - 0.02), (x, y, TABLE_TOP_M / 2 - 0.02), _TABLE)

    def _bin(self, place: Place) -> None:
        x, y = ahead(place, AHEAD_M)
        high = BIN_TOP_M / 2
        for side in (-1, 1):
            self.scene.box((BIN_WALL_HALF_M, BIN_HALF_M, high), (x + side * BIN_HALF_M, y, high), _BIN)
            self.scene.box((BIN_HALF_M, BIN_WALL_HALF_M, high), (x, y + side * BIN_HALF_M, high), _BIN)

    def _cup(self, station: Place) -> int:
        at = (*ahead(station, AHEAD_M), TABLE_TOP_M + CUP_HEIGHT_M / 2)
        body = self.scene.cylinder(CUP_RADIUS_M, CUP_HEIGHT_M, at, _CUP, CUP_MASS_KG)
        self.scene.client.changeDynamics(body, -1, lateralFriction=1.0, rollingFriction=1e-3)
        return body

    def _close_up(self) -> Pose:
        x, y, z = self.robot.arm.tip_place()
        return Pose((x + 0.9, y - 0.9, z + 0.7), (x, y, z))


MIN_RED = 0.005
"""Share of the picture's pixels; less is no cup."""


def place_of_cup(world: CleanLab) -> tuple[float, float] | None:
    """The middle of what is red in a picture of the table, in metres; None where too little is."""
    top = top_seen(world.scene, world.robot.base.place, TABLE_TOP_M, _is_cup)
    return top[:2] if top is not None else None


def _is_cup(colors: Colors) -> npt.NDArray[np.bool_]:
    red, green, blue = np.moveaxis(colors, -1, 0)
    is_red: npt.NDArray[np.bool_] = (red > 2 * green) & (red > 2 * blue) & (red > 60)
    return is_red if np.mean(is_red) > MIN_RED else np.zeros_like(is_red)
