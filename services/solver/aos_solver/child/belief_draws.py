"""The seeds of what beliefs draw, and the changes by which a new child gets a drawn belief again.

A change of the belief draws from a stream of its own, whose seed is a function of the mission's seed and the
step. So the same outcomes give the same particles, whatever the process did before or between them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import msgspec

from aos_protocol.messages import BeliefSummary

__all__ = ["BeliefDraws", "BeliefLog", "draws_of"]

_RESETTING = ("reset_belief", "draw_belief", "import_belief", "project_belief")
"""The commands after which the belief does not depend on what was before."""

REPLAY_S = 5.0
"""Longer updates are not done again: a child that is started anew then has the same particles, but not how
they came to be, so that later ones have the same distribution only."""


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


class BeliefLog:
    """The commands that have made an engine's belief, and whether a new child should be given them."""

    def __init__(self) -> None:
        self.commands: list[str] = []
        self._seconds = 0.0
        self._is_drawn = False
        self._has_lost_history = False

    def add(self, commands: Sequence[str], summary: BeliefSummary, seconds: float) -> None:
        """The commands of one change, which took so long, and what is believed after it."""
        if commands[0].partition("\t")[0] in _RESETTING:
            self.commands, self._seconds, self._has_lost_history = [], 0.0, False
        self.commands += commands
        self._seconds += seconds
        self._is_drawn = summary.error_bound >= 1

    def begin_child(self) -> bool:
        """Returns whether to give a new child the commands, so that the particles stay those of a replay."""
        replays = self._is_drawn and self._seconds <= REPLAY_S and not self._has_lost_history
        self._has_lost_history = self._has_lost_history or (self._is_drawn and not replays)
        return replays

    def told(self, summary: BeliefSummary) -> BeliefSummary:
        """The summary, which has a digest only where a replay of the outcomes would give it."""
        return msgspec.structs.replace(summary, digest="") if self._has_lost_history else summary
