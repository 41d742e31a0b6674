"""The comparison of what decisions tell with what missions return: a value with its error, against the
mean of missions."""

import dataclasses
import math
from collections import Counter
from statistics import fmean
from typing import Any

from .answers import Answers, lists_of_lists
from .problem import Problem

ALLOWED_SHARE = 0.05
"""A value may be off by this share of the range from random actions to the optimum, whatever its error."""


@dataclasses.dataclass(frozen=True)
class Told:
    """The value of the first decision, what missions returned, and the range that returns may have."""

    problem: str
    planner: str
    value: float
    error: float
    returned: float
    returned_error: float
    range: float
    at_least: float | None = None
    at_most: float | None = None

    @property
    def deviation(self) -> float:
        """The deviation in shares of the range; above 0 where too much was promised."""
        return (self.value - self.returned) / self.range

    @property
    def share_of_error(self) -> float:
        return self.error / self.range

    @property
    def is_right(self) -> bool:
        error = math.hypot(self.error, self.returned_error)
        return abs(self.value - self.returned) <= max(2 * error, ALLOWED_SHARE * self.range)

    def row(self) -> str:
        proven = f"{_text(self.at_least)} to {_text(self.at_most)}"
        cells = (
            self.problem,
            self.planner,
            f"{self.value:.4g} +- {self.error:.2g}",
            proven,
            f"{self.returned:.4g} +- {self.returned_error:.2g}",
            f"{self.range:.3g}",
            "yes" if self.is_right else "no",
        )
        return f"| {' | '.join(cells)} |"

    def text(self) -> str:
        bounds = (
            f", at least {_text(self.at_least)}, at most {_text(self.at_most)}"
            if self.at_least is not None or self.at_most is not None
            else ""
        )
        return (
            f"{self.problem} ({self.planner}): told {self.value:.4g} +- {self.error:.2g}{bounds}; "
            f"returned {self.returned:.4g} +- {self.returned_error:.2g}; the range is {self.range:.3g}"
        )


def _text(bound: float | None) -> str:
    return "?" if bound is None else f"{bound:.4g}"


@dataclasses.dataclass
class Values(Answers):
    """Values of first decisions by the planner that was asked for and the family."""

    values: dict[str, dict[str, list[Told]]] = dataclasses.field(default_factory=lists_of_lists)
    left_out: Counter[str] = dataclasses.field(default_factory=Counter)

    def add(self, problem: Problem, answer: dict[str, Any]) -> bool:
        """Takes the driver's report of missions; returns whether a value was wrong."""
        if "optimum" not in answer or any(entry["fault"] for entry in answer.get("planners", ())):
            self.crashes.append(problem.name)
            return True
        if answer["obstacle"]:
            self.left_out[answer["obstacle"]] += 1
            return False
        family = problem.name.partition("/")[0].removesuffix("+")
        found = [(entry["planner"], told_of(problem.name, entry, answer)) for entry in answer["planners"]]
        for name, compared in found:
            self.values[name][family].append(compared)
        return not all(compared.is_right for _, compared in found)

    def faults_text(self, problem: Problem, answer: dict[str, Any]) -> str:
        if "optimum" not in answer:
            return f"{problem.name}: {answer.get('crash') or answer.get('fault')}"
        found = (told_of(problem.name, entry, answer) for entry in answer["planners"])
        return "\n".join(entry.text() for entry in found if not entry.is_right)

    def all_of(self, name: str) -> list[Told]:
        return [entry for of_family in self.values[name].values() for entry in of_family]

    def share_right(self, name: str) -> float:
        return fmean(entry.is_right for entry in self.all_of(name))

    def line(self) -> str:
        return ", ".join(f"{name} {100 * self.share_right(name):.0f} % right" for name in self.values)

    def table(self) -> str:
        lines = []
        for name in self.values:
            lines += [
                f"| {name} | models | right | told less returned, % of the range | size of it | error told |",
                "|---|---:|---:|---:|---:|---:|",
            ]
            families = sorted(self.values[name].items())
            lines += [_row(family, found) for family, found in families]
            lines += [_row("all", self.all_of(name)), ""]
        lines += [f"{count} models left out: {why}" for why, count in self.left_out.items()]
        lines += self.crash_lines()
        return "\n".join(lines)

    def is_passed(self) -> bool:
        return not self.crashes and all(entry.is_right for name in self.values for entry in self.all_of(name))

    def as_json(self) -> dict[str, Any]:
        return {
            "told": {
                name: [dataclasses.asdict(entry) for entry in self.all_of(name)] for name in self.values
            },
            "left_out": self.left_out,
            "crashes": self.crashes,
        }


def told_of(problem: str, entry: dict[str, Any], answer: dict[str, Any]) -> Told:
    """A planner's part of the driver's report of missions, whose mean is without most of their luck."""
    width = answer["optimum"] - answer["random"]
    return Told(
        problem,
        entry["used"],
        entry["told"],
        entry["told_error"],
        answer["optimum"] - entry["regret"] * width,
        entry["standard_error"] * width,
        width,
        entry["at_least"],
        entry["at_most"],
    )


def _row(family: str, found: list[Told]) -> str:
    right = sum(entry.is_right for entry in found)
    deviations = [100 * entry.deviation for entry in found]
    size = fmean(abs(deviation) for deviation in deviations)
    error = fmean(100 * entry.share_of_error for entry in found)
    return f"| {family} | {len(found)} | {right} | {fmean(deviations):+.1f} | {size:.1f} | {error:.1f} |"
