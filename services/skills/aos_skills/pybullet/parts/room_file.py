"""The part of a world file that every kind of world has."""

import msgspec


class RoomFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Common options. A world whose `pictures` are off leaves none, and takes less than half as long."""

    pictures: bool = True
