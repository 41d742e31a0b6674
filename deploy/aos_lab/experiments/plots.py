"""Pictures of an experiment's figures, with intervals: the only module that draws with matplotlib."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from aos_lab.experiments.results import PartResult, Results
from aos_lab.trials.intervals import Interval

__all__ = ["draw_plots"]

_COLOURS = {"model": "#3b6ea5", "system": "#c0662f"}
_ROW_INCHES = 0.42


def _count_of(name: str) -> Callable[[PartResult], Interval | None]:
    return lambda part: part.figures.counts.get(name)


def draw_plots(results: Results, folder: Path) -> dict[str, Path]:
    """One picture for each figure that a part has, by its title; SVG files in `folder`."""
    # Texts stay texts, and the same figures give the same file.
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "aos", "font.family": "sans-serif"})
    counted = {name for part in results.parts for name in part.figures.counts}
    wanted: dict[str, Callable[[PartResult], Interval | None]] = {
        "share of missions that reach the goal": lambda part: part.figures.goal,
        "discounted return": lambda part: part.figures.value,
        "steps": lambda part: part.figures.steps,
    }
    for name in sorted(counted):
        wanted[f"{name}, times in a mission"] = _count_of(name)
    folder.mkdir(parents=True, exist_ok=True)
    drawn = {}
    for title, value_of in wanted.items():
        rows = [(part, value) for part in results.parts if (value := value_of(part)) is not None]
        if rows:
            path = folder / f"{title.partition(',')[0].replace(' ', '-')}.svg"
            _draw(title, rows, path, is_share="share" in title)
            drawn[title] = path
    return drawn


def _length(half: float) -> float:
    """Returns the length of a bar to one side; 0 where the end is not known."""
    return max(0.0, half) if math.isfinite(half) else 0.0


def _draw(title: str, rows: list[tuple[PartResult, Interval]], path: Path, *, is_share: bool) -> None:
    """A dot for each part between the ends of its interval."""
    figure = Figure(figsize=(7.0, 1.0 + _ROW_INCHES * len(rows)), layout="constrained")
    axes = figure.subplots()
    for place, (part, value) in enumerate(rows):
        ends = [[_length(value.value - value.low)], [_length(value.high - value.value)]]
        axes.errorbar(value.value, place, xerr=ends, fmt="o", capsize=4, color=_COLOURS[part.by])
    axes.set_yticks(
        range(len(rows)), [f"{part.name} ({part.by}, {part.figures.missions})" for part, _ in rows]
    )
    axes.set_ylim(len(rows) - 0.5, -0.5)
    if is_share:
        axes.set_xlim(-0.02, 1.02)
    axes.set_xlabel(f"{title}, with 95 % intervals")
    axes.grid(axis="x", alpha=0.3)
    figure.savefig(path, metadata={"Date": None})
