"""Skills that nobody can run now: after some decisions for want of them the planner searches without them."""

from collections import Counter
from collections.abc import Iterable, Mapping

_DECISIONS = 3
"""An adapter may be on its way back. Without an end a robot would get ready for its skills for ever."""


class PassedOver:
    """Counts the decisions in which a skill was worth more than what was chosen, while it was unavailable.

    What was there and has left is counted whatever it is worth; after it was waited for it is lost.
    """

    def __init__(self) -> None:
        self._decisions: Counter[str] = Counter()
        self._awaited: set[str] = set()
        self._lost: set[str] = set()

    def count(self, skills: Iterable[str]) -> None:
        """One more decision has passed over these."""
        self._decisions.update(set(skills))

    def not_awaited(self, skills: Iterable[str]) -> set[str]:
        """Returns those that are to be waited for first: they have been away since the last decision."""
        new = set(skills) - self._awaited
        self._awaited |= new
        return new

    def reasons(self, unavailable: Mapping[str, str]) -> dict[str, str]:
        """Returns the skills to do without, each with the reason; what is available again begins anew."""
        self._awaited &= unavailable.keys()
        self._lost &= unavailable.keys()
        for skill in self._decisions.keys() - unavailable.keys():
            del self._decisions[skill]
        passed = {
            skill: f"{skill} is left out after {count} decisions for want of it: {unavailable[skill]}"
            for skill, count in self._decisions.items()
            if count >= _DECISIONS
        }
        lost = {
            skill: f"{skill} is left out, as it was waited for and has not come back: {unavailable[skill]}"
            for skill in sorted(self._lost)
        }
        return {**passed, **lost}

    def to_await(self, unavailable: Mapping[str, str]) -> set[str]:
        """Returns those done without that are not known to be lost."""
        return self.reasons(unavailable).keys() - self._lost

    def lose(self, skills: Iterable[str]) -> None:
        """These were waited for in vain: the planner does without them until they are back."""
        self._lost |= set(skills)

    def forget(self) -> None:
        """Lets the planner search with all of them again but those that are lost."""
        self._decisions.clear()
