"""The form of the TurtleBot's world files."""

import msgspec

from aos_skills.pybullet.parts.room_file import Deviation, Length, Place, RoomFile, Share


class Obstacle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An upright box on the robot's map, by its centre and half its sides, in metres."""

    x: float
    y: float
    half_x: Length
    half_y: Length


class Crate(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A crate that stands there with a probability, and is on no map."""

    x: float
    y: float
    probability: Share = 1.0
    half: Length = 0.15


class FaultModel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Noise of the localisation as standard deviations; `lost_report` is a probability: the robot arrived and
    its report says that it did not."""

    place_noise_m: Deviation = 0.0
    yaw_noise_rad: Deviation = 0.0
    lost_report: Share = 0.0


class TurtlebotFile(RoomFile, frozen=True, forbid_unknown_fields=True):
    """A rectangular arena around the origin with walls, `half_x` and `half_y` half its sides.

    `places` are looked at for the record of what was visited; the robot gets its goals from its documents.
    """

    robot: Place
    half_x: Length
    half_y: Length
    places: dict[str, Place]
    obstacles: list[Obstacle] = []
    crates: dict[str, Crate] = {}
    faults: FaultModel = FaultModel()
