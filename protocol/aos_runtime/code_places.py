"""The place in somebody's Python where something happened: the innermost line that is in no library."""

import sysconfig
from collections.abc import Iterable
from traceback import FrameSummary

_LIBRARIES = (sysconfig.get_path("stdlib"), sysconfig.get_path("purelib"), "<")


def place_of(frames: Iterable[FrameSummary]) -> str:
    """File and line of a stack, the outermost frame first."""
    stack = list(frames)
    own = [frame for frame in stack if not frame.filename.startswith(_LIBRARIES)] or stack
    return f"{own[-1].filename}:{own[-1].lineno}" if own else "code without a place"
