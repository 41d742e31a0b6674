"""The Panda's gripper: two fingers that close with a limited force."""

import pybullet

from aos_skills.pybullet.parts.scene import Scene

FINGER_JOINTS = ("panda_finger_joint1", "panda_finger_joint2")
MAX_GAP_M = 0.08
GRIP_FORCE_N = 25.0
FEELS_GAP_M, FEELS_FORCE_N = 0.0003, 1.0
"""A thing that is thinner, or presses less, is taken for nothing."""


class Gripper:
    """Open when it is made."""

    def __init__(self, scene: Scene, body: int, joints: dict[str, int]) -> None:
        self._scene = scene
        self._client = scene.client
        self._body = body
        self._fingers = [joints[name] for name in FINGER_JOINTS]
        self._gap_target = MAX_GAP_M
        for finger in self._fingers:
            self._client.resetJointState(body, finger, MAX_GAP_M / 2)
            self._client.changeDynamics(body, finger, lateralFriction=1.5, spinningFriction=0.02)
        scene.motors.append(self._hold)

    @property
    def gap_m(self) -> float:
        """The distance between the fingers."""
        return float(sum(self._client.getJointState(self._body, joint)[0] for joint in self._fingers))

    def forces_n(self) -> tuple[float, float]:
        """Returns the forces with which each finger presses on things that are not the other finger."""
        forces = []
        for finger in self._fingers:
            contacts = self._client.getContactPoints(bodyA=self._body, linkIndexA=finger)
            forces.append(sum(contact[9] for contact in contacts if contact[2] != self._body))
        return forces[0], forces[1]

    @property
    def feels_something(self) -> bool:
        """True while the fingers, by their own sensors, have something between them."""
        return self.gap_m > FEELS_GAP_M and min(self.forces_n()) > FEELS_FORCE_N

    def holds(self, body: int) -> bool:
        """Returns whether both fingers touch a body."""
        touched = (
            self._client.getContactPoints(bodyA=self._body, linkIndexA=finger, bodyB=body)
            for finger in self._fingers
        )
        return all(touched)

    def close(self) -> None:
        """Closes until the fingers meet each other or something."""
        self._gap_target = 0.0
        self._scene.wait(0.6)

    def open(self) -> None:
        self._gap_target = MAX_GAP_M
        self._scene.wait(0.5)

    def _hold(self) -> None:
        self._client.setJointMotorControlArray(
            self._body,
            self._fingers,
            pybullet.POSITION_CONTROL,
            targetPositions=[self._gap_target / 2] * 2,
            forces=[GRIP_FORCE_N] * 2,
        )
