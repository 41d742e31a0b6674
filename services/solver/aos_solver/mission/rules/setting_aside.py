"""Skills that are set aside: after a row of failures nobody decides for them, for a while."""

import math
from collections.abc import Mapping

import msgspec

_COUNTS_FULLY = math.log(10)
"""The surprise from which on a failure that a rule has told counts as a whole one: one in ten."""

_NOBODY_KNOWS = ("unknown", "timed_out", "cancelled")
"""The statuses after which an adapter may have ended, or still has to."""


class _Row(msgspec.Struct):
    """Failures in a row of one skill, and how often its adapter had announced itself by then.

    `restarts` counts the announcements between failures of which nobody knows how they ended: an adapter that
    has ended in a call, or after one, was started again.
    """

    announced: int
    failures: int = 0
    weight: float = 0.0
    restarts: int = 0
    last: str = ""

    @property
    def is_of_adapter(self) -> bool:
        """True where the adapter's start is part of the failure, and says nothing new of the skill."""
        return self.last == "unknown" or (self.last in _NOBODY_KNOWS and self.restarts > 0)


class _Pause(msgspec.Struct, frozen=True):
    ends_at_s: float
    announced: int | None
    """None where an announcement does not end it."""
    reason: str


class SettingAside:
    """Counts each skill's failures in a row, whatever else ran between, and knows which are set aside.

    An adapter that announces itself anew begins a new row, and ends the pause of its skills, unless its start
    is what follows from the failures themselves.
    """

    def __init__(self) -> None:
        self._rows: dict[str, _Row] = {}
        self._pauses: dict[str, _Pause] = {}

    @staticmethod
    def weight_of_told(surprise: float) -> float:
        """Returns the weight of a failure that a rule has told: the more probable the model holds it, the
        less."""
        return min(max(surprise, 0.0) / _COUNTS_FULLY, 1.0)

    def count(self, skill: str, weight: float, announced: int, status: str) -> None:
        """One more failure in a row, with the status of its outcome."""
        row = self._rows.get(skill)
        if row is None or (row.announced != announced and row.last not in _NOBODY_KNOWS):
            row = self._rows[skill] = _Row(announced)
        row.restarts += row.announced != announced
        row.announced = announced
        # What is refused has begun nothing: it tells nothing of how the adapter ended.
        if status != "refused" or not row.last:
            row.last = status
        row.failures += 1
        row.weight += weight

    def end_row(self, skill: str) -> None:
        """The skill did what it should, or somebody has looked after it."""
        self._rows.pop(skill, None)

    def renew(self, skill: str) -> None:
        """The skill is another one: its row and its pause are over."""
        self.end_row(skill)
        self._pauses.pop(skill, None)

    def set_aside(self, skill: str, after: int, pause_s: float, now_s: float, last: str) -> str:
        """Sets a skill aside whose row counts for `after` failures; the reason, empty if it does not."""
        row = self._rows.get(skill)
        if row is None or row.weight < after - 1e-9:
            return ""
        count = f"{row.failures} failures in a row" if row.failures > 1 else "a failure"
        reason = f"{skill} is set aside for {pause_s:g} s after {count}, the last {last}"
        announced = None if row.is_of_adapter else row.announced
        self._pauses[skill] = _Pause(now_s + pause_s, announced, reason)
        return reason

    def reasons(self, now_s: float, announced: Mapping[str, int]) -> dict[str, str]:
        for skill, pause in list(self._pauses.items()):
            has_come_anew = pause.announced not in (None, announced.get(skill, 0))
            if has_come_anew:
                self._rows.pop(skill, None)
            if has_come_anew or now_s >= pause.ends_at_s:
                del self._pauses[skill]
        return {skill: pause.reason for skill, pause in self._pauses.items()}

    def s_until_return(self, now_s: float) -> float:
        """Returns how long it takes until the next skill comes back by itself; infinite where none is set
        aside."""
        return min((pause.ends_at_s - now_s for pause in self._pauses.values()), default=math.inf)
