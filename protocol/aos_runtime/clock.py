"""The time, as something a caller hands in.

Only `monotonic_s` may decide anything; the wall clock is for journals and people.
"""

from __future__ import annotations

import time
from typing import Protocol


class Clock(Protocol):
    """The questions that a component may ask about the time."""

    def now_ns(self) -> int:
        """Wall-clock nanoseconds since the epoch; may jump."""
        ...

    def monotonic_s(self) -> float:
        """Seconds that never go back, from an arbitrary origin."""
        ...


class SystemClock:
    """The machine's clocks."""

    def now_ns(self) -> int:
        return time.time_ns()

    def monotonic_s(self) -> float:
        return time.monotonic()
