from collections import defaultdict
from statistics import fmean, stdev
from typing import Any

from .mechanisms import Route


class Losses:
    """Regret of each variant of the routes' planners, by model."""

    def __init__(self, routes: list[Route]):
        self._routes = routes
        self._regrets: dict[str, dict[str, float]] = defaultdict(dict)  # by variant and model
        self.models = 0

    def add(self, model: str, report: dict[str, Any]):
        """Takes the driver's report on a model; one without a known optimum tells nothing."""
        if not report.get("planners"):
            return
        self.models += 1
        for entry in report["planners"]:
            self._regrets[entry["planner"]][model] = entry["regret"]

    def rows(self) -> list[dict[str, Any]]:
        return [self._row(route, name) for route in self._routes for name in route.mechanisms if self.models]

    def _row(self, route: Route, mechanism: str) -> dict[str, Any]:
        with_it, without = self._regrets[route.variant()], self._regrets[route.variant(mechanism)]
        lost = {model: 100 * (without[model] - regret) for model, regret in with_it.items()}
        by_family: dict[str, list[float]] = defaultdict(list)
        for model, loss in lost.items():
            by_family[model.partition("/")[0].removesuffix("+")].append(loss)
        worst = max(by_family, key=lambda family: fmean(by_family[family]))
        return {
            "planner": route.name,
            "without": mechanism,
            "models": len(lost),
            "regret with": round(100 * fmean(with_it.values()), 2),
            "regret without": round(100 * fmean(without.values()), 2),
            "loss": f"{fmean(lost.values()):.2f} ± {error_of_mean(list(lost.values())):.2f}",
            "worst family": f"{worst} {fmean(by_family[worst]):.1f}",
        }


def error_of_mean(numbers: list[float]) -> float:
    """The standard error of a mean; 0 of a single number."""
    return stdev(numbers) / len(numbers) ** 0.5 if len(numbers) > 1 else 0.0
