"""Places in world files."""

import msgspec


class Place(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A place on the floor, in metres; `yaw` in radians."""

    x: float
    y: float
    yaw: float = 0.0
