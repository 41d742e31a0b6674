"""The world file: where things stand, and the fault model."""

from __future__ import annotations

from pathlib import Path

import msgspec
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from aos_protocol.errors import DeployError

__all__ = ["Can", "FaultModel", "Place", "Table", "WorldFile", "load_world_file"]


class Place(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A place on the floor, in metres; `yaw` in radians."""

    x: float
    y: float
    yaw: float = 0.0


class Can(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A can as it is. The robot perceives it `perceived_scale` times as large, and with the probability
    `misplaced` elsewhere: where there is nothing to grasp.
    """

    x: float
    y: float
    radius: float
    height: float
    perceived_scale: float = 1.0
    misplaced: float = 0.0


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table by its centre, with its can."""

    x: float
    y: float
    can: Can


class FaultModel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Noise as standard deviations in metres, faults as probabilities."""

    pose_noise_m: float = 0.0
    height_noise_m: float = 0.0
    arm_stays_out: float = 0.0
    silent_fingers: float = 0.0


class WorldFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The room."""

    robot: Place
    tables: dict[str, Table]
    person: Place
    faults: FaultModel = FaultModel()


def load_world_file(path: Path) -> WorldFile:
    """Reads and checks a world file; DeployError AOS801 names the file and what is wrong in it."""
    try:
        data = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
        return msgspec.convert(data, WorldFile)
    except OSError as error:
        raise DeployError(
            f"{path}: cannot be read: {error.strerror}", hint="Name another world file under `world:`"
        ) from error
    except (YAMLError, UnicodeDecodeError) as error:
        raise DeployError(f"{path}: not YAML: {error}", hint="Mend the file") from error
    except msgspec.ValidationError as error:
        raise DeployError(f"{path}: {error}", hint="Compare with deploy/worlds/armadillo.yaml") from error
