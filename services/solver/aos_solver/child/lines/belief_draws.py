"""The seeds of what beliefs draw.

A change of the belief draws from a stream of its own, whose seed is a function of the mission's seed and the
step. So the same outcomes give the same particles, whatever the process did before or between them.
"""

import hashlib


def draws_of(seed: int, step: int = 0) -> int:
    """The seed of what a belief draws at a step of the mission with that seed; at 0 the initial one."""
    digest = hashlib.blake2b(f"{seed} {step}".encode(), digest_size=8).digest()
    return int.from_bytes(digest, "little")


class BeliefDraws:
    """The seeds for the belief of one engine that was started with this seed."""

    def __init__(self, seed: int) -> None:
        self._start = self._mission = seed
        self._resets = 0
        self._step = 0
        self.newest = draws_of(seed)
        """The seed of the newest change."""

    def begin(self, seed: int | None) -> int:
        """The seed for the initial belief of a mission with this seed; None is for one that has no seed."""
        self._resets += 1
        self._mission = draws_of(self._start, -self._resets) if seed is None else seed
        self._step = 0
        self.newest = draws_of(self._mission)
        return self.newest

    def of(self, step: int | None) -> int:
        """The seed for the update of a step; None is for the one after the last."""
        self._step = self._step + 1 if step is None else step
        self.newest = draws_of(self._mission, self._step)
        return self.newest

    def of_monitor(self) -> int:
        """The seed for an update by what a monitor says after a step, or after another monitor."""
        self.newest = draws_of(self.newest, 2)
        return self.newest

    def of_takeover(self) -> int:
        """The seed for a belief that comes from an engine with other variables."""
        self.newest = draws_of(self.newest, 1)
        return self.newest
