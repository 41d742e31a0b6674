"""The benchmark problems: where their documents are, and what is measured on each."""

from __future__ import annotations

from pathlib import Path

import msgspec

from aos_protocol.errors import DeployError

__all__ = ["CHECKOUT", "Problem", "problem_names", "problems_named"]

CHECKOUT = Path(__file__).resolve().parents[3]
"""Documents and baselines are measured where they are developed, and not part of an installation."""


class Problem(msgspec.Struct, frozen=True):
    """A bundle. Missions of `steps` steps at most; `runs` of them for a figure; none where `runs` is 0."""

    name: str
    bundle: Path
    runs: int = 0
    steps: int = 90
    is_searched: bool = True


def _ours(name: str, runs: int = 0, steps: int = 90) -> Problem:
    return Problem(name, CHECKOUT / "deploy/bundles/bench" / name, runs, steps)


def _theirs(name: str) -> Problem:
    return Problem(name, CHECKOUT.parent / "shared/corpus" / name, is_searched=False)


_PROBLEMS = {
    problem.name: problem
    for problem in (
        _ours("tiger", runs=200, steps=40),
        _ours("tag", runs=200),
        _ours("rocksample-7-8", runs=200),
        _ours("rocksample-11-11", runs=100),
        _ours("rocksample-15-15", runs=50),
        _ours("pocman", runs=50),
        _ours("lightdark", runs=100),
        _ours("laser", runs=100),
        _ours("laser-discrete", runs=100),
        _ours("ship10", runs=50, steps=100),
        _ours("maint10", runs=50),
        _ours("lightdark-normal", runs=100),
        _ours("laser-normal", runs=100),
        _ours("navigation"),
        _theirs("sampling-rate"),
        _theirs("wildfire"),
    )
}


def problem_names() -> list[str]:
    """All benchmarks in their usual order."""
    return list(_PROBLEMS)


def problems_named(names: list[str]) -> list[Problem]:
    """The problems of these names in their usual order, all for none; AOS805 without a checkout."""
    if not (CHECKOUT / "deploy/bundles/bench").is_dir():
        raise DeployError(
            "the benchmark problems are not installed with AOS",
            code="AOS805",
            hint="Run aos bench from a checkout of the sources",
        )
    return [problem for name, problem in _PROBLEMS.items() if not names or name in names]
