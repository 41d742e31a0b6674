"""The form of tic-tac-toe's world files."""

from typing import Literal

import msgspec

from aos_skills.pybullet.parts.room_file import Deviation, RoomFile, Share
from aos_skills.pybullet.worlds.tictactoe.rules import Rules


class FaultModel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Noise of the camera's place (metres), of each pixel (of 255) and of the sun's place (metres) as
    standard deviations. `dry_centre` is the probability that the pen leaves nothing in the middle cell."""

    camera_noise_m: Deviation = 0.0
    pixel_noise: Deviation = 0.0
    light: Deviation = 0.0
    dry_centre: Share = 0.0


class TicTacToeFile(RoomFile, frozen=True, forbid_unknown_fields=True):
    """The player against the robot, the `rules`, and what is on the board at first.

    A person types at a terminal that is connected to `port` of this machine: see `play`. `begins` says who
    draws first. `moves_made` gives numbers of random moves before that, the person's first, and how likely
    each is.
    """

    opponent: Literal["random", "perfect", "person"] = "random"
    begins: Literal["robot", "person"] = "robot"
    port: int = 7450
    rules: Rules = "row"
    moves_made: dict[int, float] = {}
    faults: FaultModel = FaultModel()
