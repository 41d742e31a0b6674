"""The benchmark problems: where their documents are, and what is measured on each."""

from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_deploy.places import cache_dir, shipped
from aos_lab.bench.rocksamples import LAYOUTS, write_bundle


class Problem(msgspec.Struct, frozen=True):
    """A bundle. Missions of `steps` steps at most; `runs` of them for a figure; none where `runs` is 0."""

    name: str
    bundle: Path
    runs: int = 0
    steps: int = 90


def _ours(name: str, runs: int = 0, steps: int = 90) -> Problem:
    return Problem(name, shipped(f"deploy/bundles/bench/{name}"), runs, steps)


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
        _ours("ship10", runs=50, steps=100),
        _ours("maint10", runs=50),
        _ours("lightdark-normal", runs=100),
        _ours("laser-normal", runs=100),
        _ours("navigation"),
    )
}


def problem_names() -> list[str]:
    """All benchmarks in their usual order."""
    return list(_PROBLEMS)


def problems_named(names: list[str]) -> list[Problem]:
    """The problems of these names in their usual order, all for none, and then bundles of the user's own.

    Whatever is not the name of a problem is the folder of a bundle.
    """
    ours = [_with_documents(problem) for name, problem in _PROBLEMS.items() if not names or name in names]
    bundles = [Path(name) for name in names if name not in _PROBLEMS]
    return [*ours, *(Problem(bundle.resolve().name, bundle, runs=50) for bundle in bundles)]


def _with_documents(problem: Problem) -> Problem:
    """The problem with its bundle, which is written where it does not come along."""
    if problem.bundle.is_dir() or problem.name not in LAYOUTS:
        return problem
    folder = cache_dir() / "bundles" / problem.name
    write_bundle(problem.name, folder)
    return replace(problem, bundle=folder)
