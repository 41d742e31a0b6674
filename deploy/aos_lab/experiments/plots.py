"""Pictures of an experiment's figures, with intervals: a row for each part, as SVG."""

import html
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from aos_lab.experiments.results import PartResult, Results
from aos_lab.trials.intervals import Interval

_COLOURS = {"model": "#3b6ea5", "system": "#c0662f"}
_WIDTH_PX, _ROW_PX, _TOP_PX, _BOTTOM_PX, _RIGHT_PX = 672, 36, 8, 48, 12
_CHARACTER_PX = 7.5
"""Room for a character of a label; letters of 13 pixels are narrower in the common fonts."""
_TICKS = 6
"""The most steps from tick to tick that an axis has."""


def _count_of(name: str) -> Callable[[PartResult], Interval | None]:
    return lambda part: part.figures.counts.get(name)


def draw_plots(results: Results, folder: Path) -> dict[str, Path]:
    """One picture for each figure that a part has, by its title; SVG files in `folder`."""
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
        rows = [
            _Row(f"{part.name} ({part.by}, {part.figures.missions})", _COLOURS[part.by], value)
            for part in results.parts
            if (value := value_of(part)) is not None
        ]
        if rows:
            path = folder / f"{title.partition(',')[0].replace(' ', '-')}.svg"
            axis = _Axis(-0.02, 1.02) if "share" in title else _axis_of(rows)
            path.write_text(_picture(title, rows, axis), encoding="utf-8")
            drawn[title] = path
    return drawn


class _Row(NamedTuple):
    """A label, and the estimate that its row shows."""

    label: str
    colour: str
    value: Interval


class _Axis(NamedTuple):
    """The figures at the left and at the right end of the picture."""

    low: float
    high: float

    def ticks(self) -> list[float]:
        """Round figures between the ends: multiples of 1, 2 or 5 times a power of ten."""
        least = (self.high - self.low) / _TICKS
        power = 10.0 ** math.floor(math.log10(least))
        step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= least)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * number for number in range(first, last + 1)]


def _ends(value: Interval) -> tuple[float, float]:
    """Returns the ends of a bar; an end that is not known is drawn at the estimate."""
    low, high = min(value.low, value.value), max(value.high, value.value)
    return low if math.isfinite(low) else value.value, high if math.isfinite(high) else value.value


def _axis_of(rows: Sequence[_Row]) -> _Axis:
    """Returns an axis that holds all bars, with a margin."""
    low = min(_ends(row.value)[0] for row in rows)
    high = max(_ends(row.value)[1] for row in rows)
    margin = 0.05 * (high - low) or 0.05 * abs(high) or 0.05
    return _Axis(low - margin, high + margin)


def _picture(title: str, rows: Sequence[_Row], axis: _Axis) -> str:
    """Returns SVG with a dot for each row between the ends of its interval."""
    left = 12 + _CHARACTER_PX * max(len(row.label) for row in rows)
    right, floor = _WIDTH_PX - _RIGHT_PX, _TOP_PX + _ROW_PX * len(rows)
    scale = (right - left) / (axis.high - axis.low)

    def place(figure: float) -> str:
        return f"{left + (figure - axis.low) * scale:.1f}"

    height = floor + _BOTTOM_PX
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH_PX}" height="{height}" '
        f'viewBox="0 0 {_WIDTH_PX} {height}" fill="none" '
        'font-family="sans-serif" font-size="13" stroke-width="1.5">',
        f'<path fill="#fff" d="M0 0h{_WIDTH_PX}v{height}H0"/>',
    ]
    grid = "".join(f"M{place(tick)} {_TOP_PX}V{floor}" for tick in axis.ticks())
    lines.append(f'<path stroke="#ddd" d="{grid}"/>')
    box = f"M{left:.1f} {_TOP_PX}H{right}V{floor}H{left:.1f}z"
    lines.append(f'<path stroke="#000" d="{box}"/>')
    middles = range(_TOP_PX + _ROW_PX // 2, floor, _ROW_PX)
    for colour in dict.fromkeys(row.colour for row in rows):
        bars, dots = "", ""
        for row, middle in zip(rows, middles, strict=True):
            if row.colour == colour:
                low, high = map(place, _ends(row.value))
                bars += f"M{low} {middle - 4}v8m0-4H{high}m0-4v8"
                dots += f"M{place(row.value.value)} {middle}h0"
        lines.append(f'<path stroke="{colour}" d="{bars}"/>')
        lines.append(f'<path stroke="{colour}" stroke-width="8" stroke-linecap="round" d="{dots}"/>')
    lines.append('<g fill="#000" text-anchor="middle">')
    lines += [f'<text x="{place(tick)}" y="{floor + 18}">{tick:.10g}</text>' for tick in axis.ticks()]
    legend = f"{html.escape(title)}, with 95 % intervals"
    lines.append(f'<text x="{(left + right) / 2:.1f}" y="{floor + 38}">{legend}</text>')
    lines.append('</g><g fill="#000" text-anchor="end">')
    for row, middle in zip(rows, middles, strict=True):
        lines.append(f'<text x="{left - 6:.1f}" y="{middle + 4}">{html.escape(row.label)}</text>')
    return "\n".join([*lines, "</g></svg>", ""])
