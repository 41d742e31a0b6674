"""Two driven wheels that stand on the floor: the robot moves as far as their contacts carry it."""

import math

import pybullet

from aos_skills.pybullet.parts.scene import STEP_S, Scene, Vector

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
            now + max(-limit, min(limit, wanted - now))
            for now, wanted, limit in zip(self._speed, self._wanted, limits, strict=True)
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
            (now - then) * self._wheel_radius_m for now, then in zip(self._turned, before, strict=True)
        )
        x, y, yaw = self.odometry
        way, turn = (left + right) / 2, (right - left) / self._separation_m
        middle = yaw + turn / 2
        self.odometry = (x + way * math.cos(middle), y + way * math.sin(middle), yaw + turn)

    def _wheel_angles(self) -> tuple[float, float]:
        left, right = (self._client.getJointState(self._body, wheel)[0] for wheel in self._wheels)
        return left, right
