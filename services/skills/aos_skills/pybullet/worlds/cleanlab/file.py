"""The form of the clean lab's world files."""

from __future__ import annotations

import msgspec

from aos_skills.pybullet.parts.room_file import Deviation, Place, RoomFile, Share


class FaultModel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Noise as a standard deviation in metres, faults as probabilities: a cup that glare hides, a cup that is
    seen where none is, and a cup that is perceived where there is nothing to grasp."""

    pose_noise_m: Deviation = 0.0
    glare: Share = 0.0
    ghost: Share = 0.0
    misplaced: Share = 0.0


class CleanLabFile(RoomFile, frozen=True, forbid_unknown_fields=True):
    """Stations and bins by name: where the robot stands in front of each. `groups` are sets of stations with
    cups on different ones."""

    robot: Place
    stations: dict[str, Place]
    bins: dict[str, Place]
    groups: list[Group]
    faults: FaultModel = FaultModel()


class Group(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """`cups` of them stand on as many of these stations."""

    stations: list[str]
    cups: int
