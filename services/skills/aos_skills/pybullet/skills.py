"""What the Armadillo can do: navigate, pick, sense, serve. Outcomes come out of the physics.

Faults that a simulator cannot produce (perception noise, an arm that stays out, fingers that report nothing)
are drawn from the seeded fault model; whether a grasp holds is not.
"""

from __future__ import annotations

import math
import random
from typing import Any

from aos_skills.pybullet.robot import TUCKED, Robot
from aos_skills.pybullet.scene import TABLE_TOP_M, TRAY_FROM_PERSON_M, TRAY_TOP_M, Scene

__all__ = ["SKILL_PATHS", "ArmadilloSkills"]

SKILL_PATHS = frozenset({"/navigate", "/pick", "/sense", "/serve"})

STRETCHED = (0.0, 0.75, 0.0, -0.75, 0.0, 1.5, 0.785)
"""Arm joint angles in radians of an arm that did not return."""
REACH_M = 0.8
CROSSING = (0.0, 0.0)
"""All ways between the places lead over the middle of the room."""
LOWEST_GRASP_M = 0.008
"""Lower, the finger tips stand on the table and do not close."""
GRASP_ABOVE_CENTRE_M = 0.006
"""What is grasped above its centre hangs, and does not turn over."""
GRASPABLE_RADII_M = (0.02, 0.038)
"""What looks larger does not fit between the fingers; what looks smaller is no can."""
MISPLACED_BY_M = 0.08
LIFT_M = 0.22
SENSING_S = 0.5
APPROACH_M = 0.25
RELEASE_HEIGHT_M = 0.05


class ArmadilloSkills:
    """The skills by activation path; each takes the request's fields and returns the answer's."""

    def __init__(self, scene: Scene, robot: Robot, seed: int) -> None:
        self.scene = scene
        self.robot = robot
        self._faults = random.Random(f"faults {seed}")
        self._noise = random.Random(f"perception {seed}")
        self.is_silent = False
        """Whether the finger sensors report nothing during this call."""
        self.has_injured = False
        self.drawn: list[str] = []
        """The faults of the current call, for the record."""

    def call(self, path: str, fields: dict[str, Any]) -> dict[str, Any]:
        """Runs a skill to its end."""
        self.drawn.clear()
        self.is_silent = self._draw("silent fingers", self.scene.file.faults.silent_fingers)
        match path:
            case "/navigate":
                return self._navigate(fields)
            case "/pick":
                return self._pick()
            case "/sense":
                return self._sense()
            case "/serve":
                return self._serve()
        raise ValueError(f"there is no skill at {path}")

    @property
    def is_holding(self) -> bool:
        """The truth, which the robot itself has to sense."""
        return any(self.robot.holds(can) for can in self.scene.cans.values())

    @property
    def sees_can(self) -> bool:
        """Whether there is something to pick where the robot is."""
        return self._can_in_reach() is not None

    def watch_person(self) -> None:
        """Remembers any touch of the person; called at every simulation step."""
        if self.scene.client.getContactPoints(bodyA=self.robot.body, bodyB=self.scene.person):
            self.has_injured = True

    def _navigate(self, fields: dict[str, Any]) -> dict[str, Any]:
        x, y, yaw = float(fields["x"]), float(fields["y"]), float(fields["yaw"])
        at_x, at_y, at_yaw = self.robot.base_place
        if math.hypot(x - at_x, y - at_y) < 0.05:
            return {"success": self.robot.drive_to(x, y, yaw)}
        has_crossed = self.robot.drive_to(*CROSSING, at_yaw)
        return {"success": has_crossed and self.robot.drive_to(x, y, yaw)}

    def _pick(self) -> dict[str, Any]:
        robot = self.robot
        robot.open_gripper()
        robot.move_arm(TUCKED)
        can = self._can_in_reach()
        if can is None:
            return {"success": True}
        x, y, height = self._perceived(can)
        above = TABLE_TOP_M + LIFT_M
        grasp = TABLE_TOP_M + max(height, LOWEST_GRASP_M)
        robot.move_tip((x, y, above))
        robot.move_tip((x, y, grasp), speed_m_s=0.15)
        robot.close_gripper()
        robot.move_tip((x, y, above))
        has_load = self.is_holding
        if has_load and self._draw("the arm stays out", self.scene.file.faults.arm_stays_out):
            robot.move_arm(STRETCHED)
            return {"success": False}
        robot.move_arm(TUCKED)
        return {"success": True}

    def _sense(self) -> dict[str, Any]:
        self.robot.wait(SENSING_S)
        return {}

    def _serve(self) -> dict[str, Any]:
        """Holds out what it has, lets go, and reports a delivery whatever happened, as the original did."""
        robot = self.robot
        x, y, _yaw = robot.base_place
        person = self.scene.file.person
        tray = (person.x - TRAY_FROM_PERSON_M, person.y)
        if math.dist((x, y), tray) < 1.5:
            robot.creep(APPROACH_M)
            robot.move_tip((*tray, TRAY_TOP_M + LIFT_M))
            robot.move_tip((*tray, TRAY_TOP_M + RELEASE_HEIGHT_M), speed_m_s=0.15)
            robot.open_gripper()
            robot.move_tip((*tray, TRAY_TOP_M + LIFT_M), speed_m_s=0.15)
            robot.move_arm(TUCKED)
            robot.creep(-APPROACH_M)
        else:
            robot.open_gripper()
        return {"success": True}

    def _can_in_reach(self) -> str | None:
        """A can that stands on a table, near enough to the arm; a fallen one is not recognised."""
        x, y, yaw = self.robot.base_place
        foot = (x + 0.25 * math.cos(yaw), y + 0.25 * math.sin(yaw))
        for name in self.scene.cans:
            can_x, can_y, can_z = self.scene.can_place(name)
            can = self.scene.file.tables[name].can
            smallest, largest = GRASPABLE_RADII_M
            is_seen = can_z > TABLE_TOP_M - 0.01 and self.scene.is_standing(name)
            is_seen = is_seen and smallest < can.radius * can.perceived_scale < largest
            if is_seen and math.dist(foot, (can_x, can_y)) < REACH_M:
                return name
        return None

    def _perceived(self, name: str) -> tuple[float, float, float]:
        """Where to grasp, as far as the robot can see: x, y, and the height above the table, in metres."""
        file = self.scene.file
        can = file.tables[name].can
        x, y, z = self.scene.can_place(name)
        noise = self._noise
        height = z - TABLE_TOP_M + GRASP_ABOVE_CENTRE_M
        if self._draw("the can is seen elsewhere", can.misplaced):
            _, _, yaw = self.robot.base_place
            x -= MISPLACED_BY_M * math.cos(yaw)
            y -= MISPLACED_BY_M * math.sin(yaw)
        return (
            x + noise.gauss(0, file.faults.pose_noise_m),
            y + noise.gauss(0, file.faults.pose_noise_m),
            height + noise.gauss(0, file.faults.height_noise_m),
        )

    def _draw(self, fault: str, probability: float) -> bool:
        happens = self._faults.random() < probability
        if happens:
            self.drawn.append(fault)
        return happens
