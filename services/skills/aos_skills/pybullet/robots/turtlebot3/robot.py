"""The TurtleBot3: drive, lidar, and an estimate of where it is.

It moves as far as the contacts of its wheels carry it.
"""

import math
import random
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pybullet

from aos_skills.pybullet.parts.scene import STEP_S, Scene, Vector
from aos_skills.pybullet.parts.urdf import joints_and_links

WHEEL_RADIUS_M = 0.033
SEPARATION_M = 0.160
LOCALISE_EVERY_S = 0.2
TRUST = 0.2
"""The share of the way to a new localisation that the estimate moves."""
LIDAR_BEHIND_M = 0.032
SCAN_EVERY_S = 0.2


class TurtleBot3:
    """Stands still at `place` when it is made.

    Where it is, it knows from its wheels and from a localisation that stands in for one by map and lidar: the
    true place with normal noise of `place_noise_m` and `yaw_noise_rad`, five times a second.
    """

    def __init__(
        self, scene: Scene, place: Vector, noise: random.Random, place_noise_m: float, yaw_noise_rad: float
    ) -> None:
        self._scene = scene
        self._noise = noise
        self._sigmas = (place_noise_m, place_noise_m, yaw_noise_rad)
        self._next_s = 0.0
        client = scene.client
        x, y, yaw = place
        self.body: int = client.loadURDF(
            str(Path(__file__).parent / "burger.urdf"),
            (x, y, 0.001),
            client.getQuaternionFromEuler((0, 0, yaw)),
        )
        joints, links = joints_and_links(client, self.body)
        wheels = joints["wheel_left_joint"], joints["wheel_right_joint"]
        for wheel in wheels:
            client.changeDynamics(self.body, wheel, lateralFriction=1.2, rollingFriction=0.0)
        # The caster's ball rolls in every direction: it carries, and holds nothing.
        client.changeDynamics(self.body, links["caster_link"], lateralFriction=0.0)
        self.drive = DifferentialDrive(scene, self.body, wheels, WHEEL_RADIUS_M, SEPARATION_M, place)
        self.lidar = Lidar(scene, self.body, links["base_scan"])
        self._next_scan_s = 0.0
        self._scanned_from = place
        self._ranges = self.lidar.turn()
        scene.watchers.append(self._localise)
        scene.wait(0.2)

    @property
    def true_place(self) -> Vector:
        """The place of the middle between the wheels; the robot itself knows `place`."""
        (x, y, _), turned = self._scene.client.getBasePositionAndOrientation(self.body)
        # Bullet gives the centre of mass, which lies behind the axle.
        yaw = self._scene.client.getEulerFromQuaternion(turned)[2]
        return x + LIDAR_BEHIND_M * math.cos(yaw), y + LIDAR_BEHIND_M * math.sin(yaw), yaw

    @property
    def place(self) -> Vector:
        """The place where the robot believes it is: x, y in metres, yaw in radians."""
        return self.drive.odometry

    def stop(self) -> None:
        self.drive.stop()

    def ranges_m(self) -> npt.NDArray[np.float64]:
        """Returns the ranges of the lidar's newest turn; it turns five times a second."""
        if self._scene.time_s >= self._next_scan_s:
            self._next_scan_s = self._scene.time_s + SCAN_EVERY_S
            self._scanned_from = self.place
            self._ranges = self.lidar.turn()
        return self._ranges

    def seen_points(self) -> npt.NDArray[np.float64]:
        """The points that the rays of that turn ended on, one a row, x and y in metres.

        From where the robot was then: while it turns, a fifth of a second makes half a metre at the far end.
        """
        ranges = self.ranges_m()
        x, y, yaw = self._scanned_from
        hit = ranges < MAX_RANGE_M - 0.01
        angles, ranges = self.lidar.angles[hit] + yaw, ranges[hit]
        at = np.array([x - LIDAR_BEHIND_M * math.cos(yaw), y - LIDAR_BEHIND_M * math.sin(yaw)])
        points: npt.NDArray[np.float64] = at + ranges[:, None] * np.stack(
            [np.cos(angles), np.sin(angles)], axis=1
        )
        return points

    def _localise(self) -> None:
        if self._scene.time_s < self._next_s:
            return
        self._next_s = self._scene.time_s + LOCALISE_EVERY_S
        measured = [
            true + self._noise.gauss(0, s) for true, s in zip(self.true_place, self._sigmas, strict=True)
        ]
        x, y, yaw = self.place
        turn = math.remainder(measured[2] - yaw, 2 * math.pi)
        self.drive.correct((x + TRUST * (measured[0] - x), y + TRUST * (measured[1] - y), yaw + TRUST * turn))


RAYS = 120
MIN_RANGE_M = 0.12
MAX_RANGE_M = 3.5


class Lidar:
    """Sits on a link of the robot, which its rays do not see because they start outside of it."""

    def __init__(self, scene: Scene, body: int, link: int) -> None:
        self._scene = scene
        self._body = body
        self._link = link
        self.angles: npt.NDArray[np.float64] = np.arange(RAYS) * 2 * math.pi / RAYS
        """The angles of the rays, in radians from straight ahead to the left."""

    def turn(self) -> npt.NDArray[np.float64]:
        """The ranges of one turn, in metres, one a ray; MAX_RANGE_M where a ray meets nothing."""
        client = self._scene.client
        at, turned = client.getLinkState(self._body, self._link, computeForwardKinematics=True)[:2]
        yaw = client.getEulerFromQuaternion(turned)[2]
        level = np.stack([np.cos(self.angles + yaw), np.sin(self.angles + yaw), np.zeros(RAYS)], axis=1)
        starts, ends = np.asarray(at) + level * MIN_RANGE_M, np.asarray(at) + level * MAX_RANGE_M
        hits = client.rayTestBatch(starts.tolist(), ends.tolist())
        return MIN_RANGE_M + np.array([hit[2] for hit in hits]) * (MAX_RANGE_M - MIN_RANGE_M)


WHEEL_TORQUE_N_M = 0.6
ACCELERATION_M_S2 = 0.6
TURN_ACCELERATION_RAD_S2 = 4.0


class DifferentialDrive:
    """`command` sets what the motors aim at; `odometry` is what the wheels' angles say, slip and all."""

    def __init__(
        self,
        scene: Scene,
        body: int,
        wheels: tuple[int, int],
        wheel_radius_m: float,
        separation_m: float,
        place: Vector,
    ) -> None:
        self._client = scene.client
        self._body = body
        self._wheels = list(wheels)
        self._wheel_radius_m = wheel_radius_m
        self._separation_m = separation_m
        self._wanted = (0.0, 0.0)
        self._speed = (0.0, 0.0)
        self.odometry = place
        """x, y in metres, yaw in radians, counted from where the robot was put."""
        self._turned = self._wheel_angles()
        scene.motors.append(self._drive)
        scene.watchers.append(self._count)

    def command(self, speed_m_s: float, turn_rad_s: float) -> None:
        """Ahead and to the left. The motors gather speed over time."""
        self._wanted = (speed_m_s, turn_rad_s)

    def stop(self) -> None:
        """Holds still; time does not pass."""
        self._wanted = self._speed = (0.0, 0.0)

    def correct(self, place: Vector) -> None:
        """Sets the odometry right."""
        self.odometry = place

    def _drive(self) -> None:
        limits = (ACCELERATION_M_S2 * STEP_S, TURN_ACCELERATION_RAD_S2 * STEP_S)
        speed, turn = (
            current + max(-limit, min(limit, wanted - current))
            for current, wanted, limit in zip(self._speed, self._wanted, limits, strict=True)
        )
        self._speed = (speed, turn)
        half = turn * self._separation_m / 2
        self._client.setJointMotorControlArray(
            self._body,
            self._wheels,
            pybullet.VELOCITY_CONTROL,
            targetVelocities=[(speed - half) / self._wheel_radius_m, (speed + half) / self._wheel_radius_m],
            forces=[WHEEL_TORQUE_N_M] * 2,
        )

    def _count(self) -> None:
        before, self._turned = self._turned, self._wheel_angles()
        left, right = (
            (after - then) * self._wheel_radius_m for after, then in zip(self._turned, before, strict=True)
        )
        x, y, yaw = self.odometry
        way, turn = (left + right) / 2, (right - left) / self._separation_m
        middle = yaw + turn / 2
        self.odometry = (x + way * math.cos(middle), y + way * math.sin(middle), yaw + turn)

    def _wheel_angles(self) -> tuple[float, float]:
        left, right = (self._client.getJointState(self._body, wheel)[0] for wheel in self._wheels)
        return left, right
