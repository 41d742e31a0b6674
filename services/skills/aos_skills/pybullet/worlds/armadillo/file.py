"""The form of the Armadillo's world files."""

import msgspec

from aos_skills.pybullet.parts.room_file import Deviation, Length, Place, RoomFile, Share


class Can(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A can as it is. The robot perceives it `perceived_scale` times as large, and with the probability
    `misplaced` elsewhere: where there is nothing to grasp."""

    x: float
    y: float
    radius: Length
    height: Length
    perceived_scale: Length = 1.0
    misplaced: Share = 0.0


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table by its centre, with its can."""

    x: float
    y: float
    can: Can


class FaultModel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Noise as standard deviations in metres, faults as probabilities."""

    pose_noise_m: Deviation = 0.0
    height_noise_m: Deviation = 0.0
    arm_stays_out: Share = 0.0
    arm_stays_out_again: Share = 0.0
    silent_fingers: Share = 0.0


class ArmadilloFile(RoomFile, frozen=True, forbid_unknown_fields=True):
    robot: Place
    tables: dict[str, Table]
    person: Place
    faults: FaultModel = FaultModel()
