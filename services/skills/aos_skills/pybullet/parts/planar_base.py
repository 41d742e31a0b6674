"""A base on three joints, along x, along y and about z, moved by motors of limited force."""

import math

import pybullet

from aos_skills.pybullet.parts.scene import STEP_S, Scene, Vector

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
DRIVE_SPEED_M_S = 1.0
TURN_SPEED_RAD_S = 1.2
DRIVE_ACCELERATION_M_S2 = 0.8
FORCES = (4000.0, 4000.0, 2000.0)


class PlanarBase:
    """Stands still at `place` (x, y in metres, yaw in radians) when it is made."""

    def __init__(self, scene: Scene, body: int, joints: dict[str, int], place: Vector) -> None:
        self._scene = scene
        self._client = scene.client
        self._body = body
        self._joints = [joints[name] for name in BASE_JOINTS]
        for joint, value in zip(self._joints, place, strict=True):
            self._client.resetJointState(body, joint, value)
        self._push((0.0, 0.0, 0.0))

    @property
    def place(self) -> Vector:
        """x, y in metres, yaw in radians."""
        x, y, yaw = (self._client.getJointState(self._body, joint)[0] for joint in self._joints)
        return x, y, yaw

    def stop(self) -> None:
        """Holds still where it is; time does not pass."""
        self._push((0.0, 0.0, 0.0))

    def drive_to(self, x: float, y: float, yaw: float) -> bool:
        """Turns, drives straight, turns; whether it arrived within the time that it should take."""
        at_x, at_y, _ = self.place
        if math.hypot(x - at_x, y - at_y) > 0.05:
            heading = math.atan2(y - at_y, x - at_x)
            if not self._turn_to(heading):
                return False
        return self._slide_to(x, y) and self._turn_to(yaw)

    def creep(self, distance_m: float) -> bool:
        """Drives straight ahead, or back."""
        x, y, yaw = self.place
        return self._slide_to(x + distance_m * math.cos(yaw), y + distance_m * math.sin(yaw))

    def _slide_to(self, x: float, y: float) -> bool:
        at_x, at_y, _ = self.place
        way = math.hypot(x - at_x, y - at_y)
        deadline_s = self._scene.time_s + 3.0 + 3 * way / DRIVE_SPEED_M_S
        speed = 0.0
        while self._scene.time_s < deadline_s:
            at_x, at_y, _ = self.place
            distance_m = math.hypot(x - at_x, y - at_y)
            if distance_m < 0.004:
                self.stop()
                self._scene.wait(0.1)
                return True
            faster = speed + DRIVE_ACCELERATION_M_S2 * STEP_S
            speed = min(faster, DRIVE_SPEED_M_S, math.sqrt(2 * DRIVE_ACCELERATION_M_S2 * distance_m))
            self._push((speed * (x - at_x) / distance_m, speed * (y - at_y) / distance_m, 0.0))
            self._scene.step()
        self.stop()
        return False

    def _turn_to(self, yaw: float) -> bool:
        deadline_s = self._scene.time_s + 8.0
        while self._scene.time_s < deadline_s:
            error = math.remainder(yaw - self.place[2], 2 * math.pi)
            if abs(error) < 0.003:
                self.stop()
                return True
            self._push((0.0, 0.0, max(-TURN_SPEED_RAD_S, min(TURN_SPEED_RAD_S, 3 * error))))
            self._scene.step()
        self.stop()
        return False

    def _push(self, velocities: Vector) -> None:
        self._client.setJointMotorControlArray(
            self._body, self._joints, pybullet.VELOCITY_CONTROL, targetVelocities=velocities, forces=FORCES
        )
