"""The Armadillo in its room: what its skills share."""

import math
from typing import Any

from aos_skills.pybullet.parts.scene import Camera, Pose, Scene
from aos_skills.pybullet.parts.world import Faults, World
from aos_skills.pybullet.robots.mobile_arm import MobileArm
from aos_skills.pybullet.worlds.armadillo.file import ArmadilloFile
from aos_skills.pybullet.worlds.armadillo.room import Room

EYE_M = (4.6, -5.6, 4.0)
FOLDED_ELBOW_RAD = -2.3
"""The elbow's angle is below this when the arm is tucked."""
BESIDE_M = 1.5
"""The distance of a table's or the person's middle from the robot's, where it stands in front of one."""
LOOKS_AT_M = (1.7, 0.0, 0.3)
CLOSE_EYE_M = (1.1, -0.9, 0.7)
"""The eye of the close-up, from the hand."""


class Armadillo(World):
    """Outcomes come out of the physics. Faults that a simulator cannot produce (perception noise, an arm that
    stays out, fingers that report nothing) are drawn; whether a grasp holds is not."""

    def __init__(self, file: ArmadilloFile, seed: int) -> None:
        self.file = file
        self.scene = Scene()
        self.room = Room(self.scene, file)
        self.robot = MobileArm(self.scene, (file.robot.x, file.robot.y, file.robot.yaw))
        self.faults = Faults(seed)
        self.camera = Camera(self.scene, Pose(EYE_M, LOOKS_AT_M), self._close_up)
        self.is_silent = False
        """True while the finger sensors report nothing during this call."""
        self.has_injured = False
        self.scene.watchers.append(self._watch_person)

    @property
    def is_holding(self) -> bool:
        """The truth, which the robot itself has to sense."""
        return any(self.robot.gripper.holds(can) for can in self.room.cans.values())

    def begin(self) -> None:
        super().begin()
        self.is_silent = self.faults.draw("silent fingers", self.file.faults.silent_fingers)

    def stop(self) -> None:
        self.robot.stop()

    def sensors(self) -> dict[str, dict[str, Any]]:
        left, right = (0.0, 0.0) if self.is_silent else self.robot.gripper.forces_n()
        gripper = {"gap_m": self.robot.gripper.gap_m, "left_force_n": left, "right_force_n": right}
        return {"/gripper": gripper, "/joints": {"positions": self.robot.arm.angles}}

    def truth(self) -> dict[str, Any]:
        room = self.room
        return {
            "base": [round(value, 3) for value in self.robot.base.place],
            "cans": {name: [round(value, 3) for value in room.can_place(name)] for name in room.cans},
            "is_holding": self.is_holding,
            "is_delivered": any(room.is_on_tray(name) for name in room.cans),
            "has_injured": self.has_injured,
            "state": self._state(),
        }

    def _state(self) -> dict[str, Any]:
        """The same in the words of the shipped documents, which do not say where a can is that is served."""
        room = self.room
        places = {name: self._place_of(name) for name in room.cans}
        state: dict[str, Any] = {f"{name}_can_at": place for name, place in places.items() if place}
        if robot_at := self._robot_at():
            state["robot_at"] = robot_at
        is_served = any(room.is_on_tray(name) for name in room.cans)
        if not is_served:
            state["holding_can"] = self.is_holding
        return state | {
            "arm_outstretched": self.robot.arm.angles[3] > FOLDED_ELBOW_RAD,
            "drink_served": is_served,
            "person_injured": self.has_injured,
        }

    def _place_of(self, name: str) -> str:
        """Returns the place of a can; empty where it was served."""
        if self.room.is_on_tray(name):
            return ""
        if self.robot.gripper.holds(self.room.cans[name]):
            return "RobotHand"
        return f"{name.capitalize()}Table" if self.room.is_to_pick(name) else "Unknown"

    def _robot_at(self) -> str:
        """Returns where the robot stands; empty where that is none of the documents' places."""
        x, y, _ = self.robot.base.place
        if math.dist((x, y), (self.file.person.x, self.file.person.y)) < BESIDE_M:
            return "Corridor"
        tables = self.file.tables.items()
        beside = (name for name, table in tables if math.dist((x, y), (table.x, table.y)) < BESIDE_M)
        return next((f"{name.capitalize()}Table" for name in beside), "")

    def _watch_person(self) -> None:
        """Remembers any touch of the person."""
        if self.scene.client.getContactPoints(bodyA=self.robot.body, bodyB=self.room.person):
            self.has_injured = True

    def _close_up(self) -> Pose:
        hand = self.robot.arm.tip_place()
        return Pose((hand[0] + CLOSE_EYE_M[0], hand[1] + CLOSE_EYE_M[1], hand[2] + CLOSE_EYE_M[2]), hand)
