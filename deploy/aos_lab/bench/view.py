"""The benchmark's report as a table for people, and as Markdown for a page."""

from collections.abc import Iterator

from rich.box import SIMPLE_HEAD
from rich.table import Table

from aos_deploy.terminal import console
from aos_deploy.views.values import Digits
from aos_lab.bench.rows import OURS, Report, Row

_HEADINGS = ("problem", "metric", "aos", "±", "compared")
_ON_THE_RIGHT = ("aos", "±")


def print_report(report: Report) -> None:
    """The header, the table, and what was left out."""
    out = console()
    for line in _header(report):
        out.print(line, highlight=False, markup=False)
    table = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for heading in _HEADINGS:
        is_number = heading in _ON_THE_RIGHT
        table.add_column(heading, justify="right" if is_number else "left", overflow="fold")
    for cells in _rows(report):
        table.add_row(*cells)
    out.print(table)
    for skipped in report.skipped:
        out.print(f"not measured: {skipped.name}: {skipped.reason}", highlight=False, markup=False)


def markdown(report: Report) -> str:
    """The same for a page of documentation."""
    rule = ["---:" if heading in _ON_THE_RIGHT else "---" for heading in _HEADINGS]
    lines = [*_header(report), ""]
    lines += [f"| {' | '.join(cells)} |" for cells in (_HEADINGS, rule, *_rows(report))]
    if report.skipped:
        lines += ["", "Not measured:", ""]
        lines += [f"- {skipped.name}: {skipped.reason}" for skipped in report.skipped]
    return "\n".join(lines)


def _header(report: Report) -> list[str]:
    machine = report.machine
    versions = ", ".join(f"{name} {version}" for name, version in machine.versions.items())
    return [
        f"{machine.date}, {machine.processor}, {machine.cores} cores, load {machine.load:.1f}.",
        f"{machine.system}, {versions}, {machine.compiler}, seed {machine.seed}.",
        f"Rates are per second of processor time. Returns are discounted, "
        f"with {machine.budget_s:g} s of it for each decision.",
    ]


def _rows(report: Report) -> Iterator[list[str]]:
    """One for each of our rows, with the figure that it is compared with."""
    for row in report.rows:
        if row.name != OURS:
            continue
        yield [row.problem, _what(row), _short(row.value), _short(row.stderr), _comparison(row)]


def _what(row: Row) -> str:
    """`simulations/s, uniform`; `return, pomcp, 200 runs`."""
    metric, comma, kind = row.metric.partition(", ")
    return f"{metric}/s{comma}{kind}" if row.unit == "1/s" else f"{row.metric}, {row.unit}"


def _comparison(row: Row) -> str:
    """`0.53 of 268M by hand`."""
    if row.ratio is None:
        return ""
    return f"{_short(row.ratio)} of {_short(row.value / row.ratio)} {row.against}"


def _short(value: float) -> str:
    """Three digits, with `k` for thousands and `M` for millions."""
    for size, letter in ((1e6, "M"), (1e3, "k")):
        if abs(value) >= size:
            return f"{_three(value / size)}{letter}"
    return _three(value)


def _three(value: float) -> str:
    size = abs(value)
    if size >= 10:
        return f"{value:.0f}" if size >= 100 else f"{value:.1f}"
    return Digits.of([value], 2).plain(value)
