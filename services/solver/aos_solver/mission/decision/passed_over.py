"""Skills that nobody can run now: they are waited for, and then the planner searches without them.

Loops of document code that no draw can end are told here as well.
"""

from collections import Counter
from collections.abc import Set

from aos_solver.child.engine import Engine
from aos_solver.mission.ports import Available

_DECISIONS = 3
"""An adapter may be on its way back. Without an end a robot would get ready for its skills for ever."""
_RETURN_S = 5.0
"""An adapter whose start nobody tells, such as one that somebody else starts, may come within this time."""
_LOOK_S = 0.5
_LEAST_LOOK_S = 0.001  # Without a robot nothing is waited for, and the time stands still.


class PassedOver:
    """Counts the decisions in which a skill was worth more than what was chosen, while it was unavailable.

    What was there and has left is counted whatever it is worth; after it was waited for it is lost. What is
    expected back is waited for as long as a mission may hold, `hold_s`.
    """

    def __init__(self, around: Available, hold_s: float) -> None:
        self._around = around
        self._hold_s = hold_s
        self._decisions: Counter[str] = Counter()
        self._awaited: set[str] = set()
        self._lost: set[str] = set()

    def count(self, worth_more: Set[str], others: Set[str]) -> None:
        """One more decision has passed over skills that are worth more, and over others that are away."""
        self._decisions.update(worth_more | self._left(others))

    def reasons(self) -> dict[str, str]:
        """Returns the skills to do without, each with the reason; what is available again begins anew."""
        unavailable = self._around.unavailable
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

    async def are_searched_anew(self) -> bool:
        """Returns whether skills were passed over; they are not any more, as their adapters may come back.

        That is waited for: decisions for want of them would use the mission's steps up in a moment.
        """
        away = self.reasons().keys() - self._lost
        if not away:
            return False
        await self._wait_for(away)
        self._decisions.clear()
        return True

    async def are_waited_for(self, skills: Set[str]) -> bool:
        """Waits once per absence; returns whether a search is due, with those back or without those lost."""
        awaited = self._left(skills) - self._awaited
        self._awaited |= awaited
        await self._wait_for(awaited)
        return bool(awaited)

    async def _wait_for(self, away: Set[str]) -> None:
        """Waits for skills that are away, if any, until one of them has come back or the time is over.

        While an adapter of theirs is expected back the time stands still. What has not come back is lost.
        """
        now_s = self._around.clock.monotonic_s
        left_s, ends_at_s = _RETURN_S if away else 0.0, now_s() + self._hold_s
        while left_s > 0 and away <= self._around.unavailable.keys():
            began_s = now_s()
            await self._around.until_changed(_LOOK_S)
            if not away & set(self._around.returning) or now_s() > ends_at_s:
                left_s -= min(max(now_s() - began_s, _LEAST_LOOK_S), _LOOK_S)  # A pause is no waiting.
        self._lost |= self._left(away)

    def _left(self, skills: Set[str]) -> set[str]:
        """Those of the skills that are away and were there before."""
        away = skills & self._around.unavailable.keys()
        return {skill for skill in away if self._around.announced.get(skill)}


class EndlessLoops:
    """Tells of each loop of each model once."""

    def __init__(self) -> None:
        self._told: set[tuple[str, int]] = set()

    async def newly_found(self, engine: Engine) -> list[str]:
        """Returns a text for each loop without an end that steps have come to since the last call."""
        texts: list[str] = []
        for loop, place in await engine.endless_loops():
            key = engine.model_digest, loop.loop
            if key not in self._told:
                self._told.add(key)
                texts.append(f"{place}: {loop.text}, which counts as a failure")
        return texts
