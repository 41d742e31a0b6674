"""Words for a log that come again and again: the first of a kind is told, and then each time that there were
ten times as many."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

_KINDS = 1000
"""So many kinds are told apart; all others count as one."""


class Recurring:
    """Counts by kind, and hands to `tell` what is worth a line."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._counts: Counter[str] = Counter()

    def count(self, kind: str, text: str = "") -> None:
        """Takes one more of a kind; the text, by default the kind itself, is what is told of it."""
        text = text or kind
        if kind not in self._counts and len(self._counts) >= _KINDS:
            kind = text = "and others"
        self._counts[kind] += 1
        count = self._counts[kind]
        if count == 1:
            self._tell(text)
        elif str(count).strip("0") == "1":
            self._tell(f"{text}, {count} times by now")
