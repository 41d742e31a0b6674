import dataclasses
from collections import defaultdict
from typing import Any

from .problem import Problem


def lists() -> defaultdict[str, list[Any]]:
    return defaultdict(list)


def lists_of_lists() -> defaultdict[str, defaultdict[str, list[Any]]]:
    return defaultdict(lists)


@dataclasses.dataclass
class Answers:
    """The problems at which the engine failed; the results of an exam add what they count."""

    crashes: list[str] = dataclasses.field(default_factory=list, kw_only=True)

    def has_crashed(self, problem: Problem, answer: dict[str, Any], wanted: str) -> bool:
        if wanted in answer:
            return False
        self.crashes.append(problem.name)
        return True

    def crash_lines(self, indent: str = "") -> list[str]:
        return [f"{indent}crashed: {', '.join(self.crashes)}"] if self.crashes else []
