"""The room: floor, walls, tables, cans, and the person with a tray."""

import pybullet

from aos_skills.pybullet.parts.scene import Color, Scene, Vector
from aos_skills.pybullet.worlds.armadillo.file import ArmadilloFile, Can, Table

TABLE_TOP_M = 0.5
TABLE_HALF_M = (0.5, 0.4)
TRAY_TOP_M = 0.72
TRAY_HALF_M = 0.14
TRAY_RIM_HALF_M = (0.006, 0.015)
"""Half its thickness and half its height."""
TRAY_FROM_PERSON_M = 0.36
UPRIGHT = 0.9
"""The least cosine of a standing can's tilt."""

_WOOD = (0.72, 0.53, 0.34, 1)
_WALL = (0.87, 0.88, 0.84, 1)
_FLOOR = (0.62, 0.66, 0.70, 1)
_EASY, _HARD = (0.80, 0.13, 0.15, 1), (0.95, 0.65, 0.10, 1)
_SHIRT, _SKIN, _TRAY = (0.16, 0.36, 0.62, 1), (0.93, 0.76, 0.62, 1), (0.92, 0.92, 0.94, 1)


class Room:
    """Every body but the robot."""

    def __init__(self, scene: Scene, file: ArmadilloFile) -> None:
        self._scene = scene
        self._file = file
        scene.box((6, 6, 0.05), (2, 0, -0.05), _FLOOR)
        self._walls()
        self.cans = {name: self._table_with_can(table, name) for name, table in file.tables.items()}
        self.person = self._person()

    def can_place(self, name: str) -> Vector:
        """Returns the place of a can's centre, in metres."""
        return self._scene.place(self.cans[name])

    def is_standing(self, name: str) -> bool:
        """Returns whether a can stands upright, wherever that is."""
        return self._scene.uprightness(self.cans[name]) > UPRIGHT

    def is_to_pick(self, name: str) -> bool:
        """Returns whether a can stands on a table; a fallen one is not recognised."""
        return self.can_place(name)[2] > TABLE_TOP_M - 0.01 and self.is_standing(name)

    def is_on_tray(self, name: str) -> bool:
        """Returns whether the person has that can."""
        x, y, z = self.can_place(name)
        person = self._file.person
        tray_x = person.x - TRAY_FROM_PERSON_M
        is_above = abs(x - tray_x) < TRAY_HALF_M and abs(y - person.y) < TRAY_HALF_M
        return is_above and TRAY_TOP_M - 0.02 < z < TRAY_TOP_M + 0.1

    def _walls(self) -> None:
        """The room is open to the camera's side; the corridor leaves it at x = 2.5 m."""
        box = self._scene.box
        box((2.2, 0.05, 0.5), (0.2, 3.9, 0.5), _WALL)
        box((0.05, 3.9, 0.5), (-2.0, 0, 0.5), _WALL)
        box((0.05, 1.35, 0.5), (2.4, 2.55, 0.5), _WALL)
        box((1.9, 0.05, 0.5), (4.3, 1.2, 0.5), _WALL)

    def _table_with_can(self, table: Table, name: str) -> int:
        box = self._scene.box
        thickness = 0.02
        half_x, half_y = TABLE_HALF_M
        box((half_x, half_y, thickness), (table.x, table.y, TABLE_TOP_M - thickness), _WOOD)
        leg = (TABLE_TOP_M - 2 * thickness) / 2
        for side_x in (-1, 1):
            for side_y in (-1, 1):
                at = (table.x + side_x * (half_x - 0.04), table.y + side_y * (half_y - 0.04), leg)
                box((0.03, 0.03, leg), at, _WOOD)
        return self._can(table.can, _EASY if name == "easy" else _HARD)

    def _can(self, can: Can, color: Color) -> int:
        # A full can weighs a tenth of a kilogram; a tenth of its size, a thousandth of that.
        mass = max(0.1 * (can.radius / 0.033) ** 3, 0.002)
        body = self._scene.cylinder(
            can.radius, can.height, (can.x, can.y, TABLE_TOP_M + can.height / 2), color, mass
        )
        self._scene.client.changeDynamics(
            body, -1, lateralFriction=1.0, rollingFriction=1e-4, spinningFriction=1e-3
        )
        return body

    def _person(self) -> int:
        """A standing figure that holds a tray towards the robot."""
        client, box, place = self._scene.client, self._scene.box, self._file.person
        x, y = place.x, place.y
        box((0.09, 0.16, 0.4), (x, y, 0.4), (0.2, 0.2, 0.25, 1))
        body = box((0.12, 0.22, 0.3), (x, y, 1.1), _SHIRT)
        head = client.createVisualShape(pybullet.GEOM_SPHERE, radius=0.13, rgbaColor=_SKIN)
        client.createMultiBody(0, -1, head, (x, y, 1.55))
        for side in (-1, 1):
            arm = (x - TRAY_FROM_PERSON_M / 2, y + side * 0.18, TRAY_TOP_M + 0.03)
            box((TRAY_FROM_PERSON_M / 2, 0.035, 0.035), arm, _SKIN)
        tray = (x - TRAY_FROM_PERSON_M, y, TRAY_TOP_M - 0.01)
        box((TRAY_HALF_M, TRAY_HALF_M, 0.01), tray, _TRAY)
        rim = TRAY_HALF_M - TRAY_RIM_HALF_M[0]
        thin, high = TRAY_RIM_HALF_M
        for side in (-1, 1):
            at_x, at_y, at_z = tray[0] + side * rim, y + side * rim, TRAY_TOP_M + high
            box((thin, TRAY_HALF_M, high), (at_x, y, at_z), _TRAY)
            box((TRAY_HALF_M, thin, high), (tray[0], at_y, at_z), _TRAY)
        return body
