"""The parts of world files that several kinds of worlds have."""

from typing import Annotated

import msgspec


class Place(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A place on the floor, in metres; `yaw` in radians."""

    x: float
    y: float
    yaw: float = 0.0


Share = Annotated[float, msgspec.Meta(ge=0, le=1)]
"""A probability."""
Deviation = Annotated[float, msgspec.Meta(ge=0)]
"""A standard deviation."""
Length = Annotated[float, msgspec.Meta(gt=0)]
"""A length, or a factor of one."""


class RoomFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Common options. A world whose `pictures` are off leaves none, and takes less than half as long."""

    pictures: bool = True
