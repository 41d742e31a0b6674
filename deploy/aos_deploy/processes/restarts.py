"""The rule for starting a process again that has ended: the one table for services, adapters and programs."""

from collections import deque

STARTS = 5
"""A process is started so many times within WITHIN_S at most."""

STARTS_OF_ADAPTER = 10
"""An adapter that was ready after its last start is started so many times: three skills that end it in each
call are set aside before."""

WITHIN_S = 60.0

_FIRST_S = 0.2
_LONGEST_S = 5.0


class Restarts:
    """The starts of one process, by a monotonic clock in seconds."""

    def __init__(self, *, is_adapter: bool = False) -> None:
        self.count = 0
        self._is_adapter = is_adapter
        self._in_vain = 0
        self._recent: deque[float] = deque(maxlen=STARTS_OF_ADAPTER)

    def start(self, now_s: float) -> None:
        """Takes note of a start."""
        self.count += 1
        self._in_vain += 1
        self._recent.append(now_s)

    def succeed(self) -> None:
        """Takes note that the process is ready."""
        self._in_vain = 0

    @property
    def most(self) -> int:
        """The number of starts within WITHIN_S after which the process is not started again."""
        return STARTS_OF_ADAPTER if self._is_adapter and not self._in_vain else STARTS

    def are_left(self, now_s: float) -> bool:
        """Says whether the process may be started again."""
        return self._recent_starts(now_s) < self.most

    def delay_s(self, now_s: float, *, is_cut: bool = False) -> float:
        """Returns how long the next start waits: 0.2 s after the first, then twice as long each time.

        Where a connection was cut, those starts alone count that were in vain, and without one it is made
        again at once.
        """
        if is_cut and not self._in_vain:
            return 0.0
        recent = self._in_vain if is_cut else self._recent_starts(now_s)
        return min(_FIRST_S * 2.0 ** max(recent - 1, 0), _LONGEST_S)

    def _recent_starts(self, now_s: float) -> int:
        return sum(now_s - at_s <= WITHIN_S for at_s in self._recent)
