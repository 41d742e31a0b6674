"""`aos bench`: the planner's figures on problems of the literature."""

import asyncio
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, NamedTuple, get_args

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table

from aos_deploy.options import AsJson, TrustDocuments, command, seconds
from aos_deploy.places import cache_dir
from aos_deploy.printing import print_json
from aos_deploy.terminal import console, progress
from aos_deploy.views.values import Digits
from aos_lab.bench.problems import problem_names, problems_named
from aos_lab.bench.rows import OURS, Report, Row
from aos_lab.bench.suite import METRICS, Effort, Suite
from aos_solver.child.engine import Planner

PLANNERS: tuple[Planner, ...] = get_args(Planner)

_QUICK_RUNS = 4

Quick = Annotated[bool, typer.Option("--quick", help="Short measurements, and 4 missions a return")]


class BenchOptions(NamedTuple):
    """The problems, and what is measured of them."""

    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME]...",
            help=f"Of {', '.join(problem_names())}, or a bundle's folder; all the named if left out",
        ),
    ] = None
    metric: Annotated[
        list[str] | None, typer.Option(help=f"Of {', '.join(METRICS)}, repeatable; else all")
    ] = None
    runs: Annotated[
        int | None, typer.Option(min=1, help="Missions for a return; else 50 to 200, as the problem needs")
    ] = None
    time_s: Annotated[float, seconds("--time", least=0.001, help="Processor seconds of a decision")] = 0.1
    planner: Annotated[
        list[str] | None, typer.Option(help=f"Of {', '.join(PLANNERS)}, repeatable; else auto")
    ] = None
    jobs: Annotated[int, typer.Option(min=1, help="Missions at a time")] = 1
    seed: Annotated[int, typer.Option(min=0, help="Of every random draw")] = 1
    quick: Quick = False

    @property
    def effort(self) -> Effort:
        """The extent of each measurement; BadParameter for a name that is none."""
        return Effort(
            metrics=tuple(_known(self.metric or [], METRICS, "--metric")) or METRICS,
            repetitions=2 if self.quick else 5,
            seconds=0.2 if self.quick else 1.0,
            peer_simulations=500 if self.quick else 4_000,
            runs=self.runs or (_QUICK_RUNS if self.quick else None),
            budget_s=self.time_s,
            planners=_planners(self.planner or ["auto"]),
            jobs=self.jobs,
            seed=self.seed,
        )


@command("Example: aos bench tiger rocksample-7-8 --quick")
def bench(
    options: BenchOptions,
    as_json: AsJson = False,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print a table for a page")] = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Measure sampling, search and returns.

    Against hand-written C++, and against pomdp-py if it is installed. All of it
    takes an hour, with --quick some minutes.
    """
    effort = options.effort
    with progress() as bar:
        task = bar.add_task("starting")

        def on_step(what: str) -> None:
            bar.update(task, description=what, advance=1)

        suite = Suite(problems_named(_bundles_or_known(options.names or [])), effort, cache_dir(), on_step)
        bar.update(task, total=suite.steps)
        report = asyncio.run(suite.run())
    if as_json:
        print_json(report)
    elif as_markdown:
        typer.echo(markdown(report))
    else:
        print_report(report)
    raise typer.Exit(0 if report.rows else 1)


def _bundles_or_known(names: list[str]) -> list[str]:
    for name in names:
        if name not in problem_names() and not Path(name).is_dir():
            what = f"{name} is no folder of a bundle, and none of {', '.join(problem_names())}"
            raise typer.BadParameter(what, param_hint="NAME")
    return names


def _planners(names: list[str]) -> tuple[Planner, ...]:
    _known(names, PLANNERS, "--planner")
    return tuple(planner for planner in PLANNERS if planner in names)


def _known(given: list[str], known: list[str] | tuple[str, ...], hint: str) -> list[str]:
    for name in given:
        if name not in known:
            raise typer.BadParameter(f"{name} is none of {', '.join(known)}", param_hint=hint)
    return given


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
