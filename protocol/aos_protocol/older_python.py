"""The parts of newer Pythons that Python 3.10 lacks, for robots on Ubuntu 22.04 and ROS 2 Humble."""

import sys

__all__ = ["StrEnum"]

if sys.version_info >= (3, 11):
    from enum import StrEnum
else:
    from enum import Enum

    class StrEnum(str, Enum):
        """`enum.StrEnum`: a member is its text."""

        __str__ = str.__str__
        __format__ = str.__format__
