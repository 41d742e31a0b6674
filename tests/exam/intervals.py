"""Values and margins that a search tells, against the truth: are they within two standard errors of it?"""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from typing import Any

from .problem import Problem

__all__ = ["HELD_TARGET", "Intervals"]

HELD_TARGET = 0.93
"""The share of intervals that shall hold the truth."""

_NARROW = 0.5
"""A bracket of the truth is narrow enough if it is less than this share of a standard error."""
_ROUNDING = 1e-6


@dataclasses.dataclass
class Intervals:
    """Decisions by POMCP: how often value and margin were right, and the sign of a margin that was sure."""

    counts: Counter[str] = dataclasses.field(default_factory=Counter)
    crashes: list[str] = dataclasses.field(default_factory=list)

    def add(self, problem: Problem, answer: dict[str, Any]) -> bool:
        """Takes the driver's report; returns whether a margin that was sure had the wrong sign."""
        if "cases" not in answer:
            self.crashes.append(problem.name)
            return True
        before = self.counts["wrong signs"]
        for chosen, other in answer["cases"]:
            self._take(chosen, other)
        return self.counts["wrong signs"] > before

    def _take(self, chosen: list[float], other: list[float]) -> None:
        """Each has the value, its standard error, the ends of the truth, and both by a search of it alone.

        The margin is that of `aos why`: over the other action by a search of it alone.
        """
        q, error, low, high, _, _ = chosen
        told_q, told_error, other_low, other_high, other_q, other_error = other
        margin_error = math.hypot(error, other_error)
        if high - low > _NARROW * error + 1e-4 or other_high - other_low > _NARROW * margin_error + 1e-4:
            self.counts["unknown"] += 1
            return
        margin = q - other_q
        self.counts["decisions"] += 1
        self.counts["values held"] += _overlaps(q, error, low, high)
        self.counts["held in one search"] += _overlaps(
            q - told_q, math.hypot(error, told_error), low - other_high, high - other_low
        )
        self.counts["margins held"] += _overlaps(margin, margin_error, low - other_high, high - other_low)
        if abs(margin) > 2 * margin_error:
            self.counts["sure"] += 1
            truth = high - other_low if margin > 0 else other_high - low
            self.counts["wrong signs"] += truth < -_ROUNDING

    def faults_text(self, problem: Problem, answer: dict[str, Any]) -> str:
        """Returns what is wrong about a model, for people."""
        if "cases" not in answer:
            return f"{problem.name}: {answer.get('crash') or answer.get('fault')}"
        return f"{problem.name}: a margin that was told as sure has the other sign: {answer['cases']}"

    def line(self) -> str:
        """Returns how far it is."""
        return f"{self.counts['margins held']} of {self.counts['decisions']} margins held"

    def table(self) -> str:
        """Returns all of it for people."""
        found = self.counts
        decided, right = found["decisions"], found["sure"] - found["wrong signs"]
        lines = [
            f"{found['values held']} of {decided} values within two standard errors of the optimum",
            f"{found['margins held']} of {decided} margins within two standard errors of the exact one",
            f"{found['held in one search']} of {decided} if both values are of the search that decided",
            f"{right} of {found['sure']} margins that are sure have the exact sign",
            f"{found['unknown']} decisions left out, whose truth is not known well enough",
        ]
        return "\n".join([*lines, *([f"crashed: {', '.join(self.crashes)}"] if self.crashes else [])])

    def is_passed(self) -> bool:
        """Returns whether enough margins held the truth, and no sign was wrong."""
        is_held = self.counts["margins held"] >= HELD_TARGET * self.counts["decisions"] > 0
        return is_held and not self.counts["wrong signs"] and not self.crashes

    def as_json(self) -> dict[str, Any]:
        """Returns the counts as data."""
        return {"counts": dict(self.counts), "crashes": self.crashes}


def _overlaps(value: float, error: float, low: float, high: float) -> bool:
    """Says whether a value is within two standard errors of the truth."""
    return low - 2 * error - _ROUNDING <= value <= high + 2 * error + _ROUNDING
