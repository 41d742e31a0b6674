"""Places in world files."""

from __future__ import annotations

import msgspec

__all__ = ["Place"]


class Place(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A place on the floor, in metres; `yaw` in radians."""

    x: float
    y: float
    yaw: float = 0.0
