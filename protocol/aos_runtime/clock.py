"""The time, as something a caller hands in.

Only `monotonic_s` may decide anything; the wall clock is for journals and people.
"""

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
    def now_ns(self) -> int:
        return time.time_ns()

    def monotonic_s(self) -> float:
        return time.monotonic()


def moment_s(clock: Clock, stamp_ns: int) -> float:
    """The monotonic time of a moment in the past, for what lasts for a while after it.

    Journals have the wall clock alone. Where that was set back since, the moment counts as now.
    """
    return clock.monotonic_s() - max(clock.now_ns() - stamp_ns, 0) / 1e9
