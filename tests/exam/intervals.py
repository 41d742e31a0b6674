"""Values and margins that a search tells, against the truth: are they within two standard errors of it?"""

import dataclasses
import statistics
from collections import Counter
from typing import Any

from aos_solver.study.flips import sampled_flip
from aos_solver.study.valuing import Margin, Value

from .answers import Answers
from .problem import Problem

HELD_TARGET = 0.93
"""The share of intervals that shall hold the truth."""

_NARROW = 0.5
"""A bracket of the truth is narrow enough if it is less than this share of a standard error."""
_ROUNDING = 1e-6


@dataclasses.dataclass
class Intervals(Answers):
    """Decisions by POMCP: how often value and margin were right, and the sign of a margin that was sure."""

    counts: Counter[str] = dataclasses.field(default_factory=Counter)
    widths: list[float] = dataclasses.field(default_factory=list)

    def add(self, problem: Problem, answer: dict[str, Any]) -> bool:
        """Takes the driver's report; returns whether a margin that was sure had the wrong sign."""
        if self.has_crashed(problem, answer, "cases"):
            return True
        before = self.counts["wrong signs"]
        for chosen, other, line in answer["cases"]:
            margin = self._take(chosen, other)
            if margin is not None and line:
                self._take_line(margin, line)
        return self.counts["wrong signs"] > before

    def _take(self, chosen: list[float], other: list[float]) -> Margin | None:
        """Each has the value, its standard error, the ends of the truth, and both by a search of it alone.

        Value and margin are those of `aos why`.
        """
        low, high, other_low, other_high = (*chosen[2:4], *other[2:4])
        decided, alone, told, rival = (
            Value(*pair) for pair in (chosen[:2], chosen[4:], other[:2], other[4:])
        )
        value = decided.beside(alone)
        margin = Margin.of(value, rival)
        if (
            high - low > _NARROW * value.stderr + 1e-4
            or other_high - other_low > _NARROW * margin.stderr + 1e-4
        ):
            self.counts["unknown"] += 1
            return None
        exact = (low - other_high, high - other_low)
        self.counts["decisions"] += 1
        self.counts["values held"] += _overlaps(value.q, value.stderr, low, high)
        self.counts["values held in one search"] += _overlaps(decided.q, decided.stderr, low, high)
        one = Margin.of(decided, told)
        self.counts["margins held in one search"] += _overlaps(one.value, one.stderr, *exact)
        self.counts["margins held"] += _overlaps(margin.value, margin.stderr, *exact)
        if not margin.is_close:
            self.counts["sure"] += 1
            truth = exact[1] if margin.value > 0 else -exact[0]
            self.counts["wrong signs"] += truth < -_ROUNDING
        return margin

    def _take_line(self, margin: Margin, line: list[Any]):
        """The line has the probability now, places with values of both actions, whether the truth is known,
        and between which probabilities the exact choice changes.
        """
        now, beside, is_known, changes = line
        if not is_known:
            self.counts["unknown lines"] += 1
            return
        places = [(p, Margin.of(Value(q, e), Value(other, error))) for p, q, e, other, error in beside]
        told = sampled_flip([*places, (now, margin)], now)
        self.counts["lines"] += 1
        self.counts["lines with a change"] += bool(changes)
        if told is not None:
            low, high, is_certain = told
            is_inside = [low <= right and left <= high for left, right in changes]
            self.counts["certain changes"] += is_certain
            self.counts["certain changes right"] += is_certain and any(is_inside)
            self.widths.append(high - low)
            if changes:
                near = min(
                    range(len(changes)), key=lambda n: max(changes[n][0] - now, now - changes[n][1], 0)
                )
                self.counts["changes held"] += is_inside[near]

    def faults_text(self, problem: Problem, answer: dict[str, Any]) -> str:
        if "cases" not in answer:
            return f"{problem.name}: {answer.get('crash') or answer.get('fault')}"
        return f"{problem.name}: a margin that was told as sure has the other sign: {answer['cases']}"

    def line(self) -> str:
        return f"{self.counts['margins held']} of {self.counts['decisions']} margins held"

    def table(self) -> str:
        found = self.counts
        decided, right = found["decisions"], found["sure"] - found["wrong signs"]
        lines = [
            f"{found['values held']} of {decided} values within two standard errors of the optimum",
            f"{found['values held in one search']} of {decided} if the value is of the search that decided",
            f"{found['margins held']} of {decided} margins within two standard errors of the exact one",
            f"{found['margins held in one search']} of {decided} if both are of the search that decided",
            f"{right} of {found['sure']} margins that are sure have the exact sign",
            f"{found['unknown']} decisions left out, whose truth is not known well enough",
            f"{found['changes held']} of {found['lines with a change']} exact changes of the choice in the "
            f"interval that is told, on {found['lines']} lines of beliefs",
            f"{found['certain changes right']} of {found['certain changes']} changes for certain are there",
            *self._widths(),
            f"{found['unknown lines']} lines left out, along which the truth is not known well enough",
        ]
        return "\n".join([*lines, *self.crash_lines()])

    def _widths(self) -> list[str]:
        if not self.widths:
            return []
        whole = sum(width >= 1 for width in self.widths)
        return [
            f"intervals are {statistics.median(self.widths):.2f} wide in the median, and {whole} of "
            f"{len(self.widths)} reach from 0 to 1"
        ]

    def is_passed(self) -> bool:
        is_held = all(
            self.counts[held] >= HELD_TARGET * self.counts[of]
            for held, of in (
                ("values held", "decisions"),
                ("margins held", "decisions"),
                ("changes held", "lines with a change"),
                ("certain changes right", "certain changes"),
            )
        )
        return (
            is_held and self.counts["decisions"] > 0 and not self.counts["wrong signs"] and not self.crashes
        )

    def as_json(self) -> dict[str, Any]:
        return {"counts": dict(self.counts), "crashes": self.crashes}


def _overlaps(value: float, error: float, low: float, high: float) -> bool:
    return low - 2 * error - _ROUNDING <= value <= high + 2 * error + _ROUNDING
