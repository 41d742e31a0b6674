"""Following a way with two wheels: turn towards a point a little ahead on it, and drive."""

import itertools
import math
from collections.abc import Callable
from enum import Enum, auto

from aos_skills.pybullet.parts.differential_drive import DifferentialDrive
from aos_skills.pybullet.parts.route import Point
from aos_skills.pybullet.parts.scene import Scene

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
