"""The report of a benchmark: rows of figures, what was left out and why, and on what machine it was."""

import datetime
import os
import platform
import statistics
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_protocol import __version__
from aos_runtime.distribution import version_of

OURS = "aos"


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """One figure. `name` is who was measured, `stderr` that of the mean over repetitions or runs.

    `ratio` is `value` over the figure of `against`, if anybody else was measured.
    """

    name: str
    problem: str
    metric: str
    value: float
    stderr: float
    unit: str
    against: str = ""
    ratio: float | None = None


class Skipped(msgspec.Struct, frozen=True):
    """Something that was not measured."""

    name: str
    reason: str


class Machine(msgspec.Struct, frozen=True):
    """The circumstances of a benchmark. `load` is of the last minute, `budget_s` a decision's processor
    time."""

    processor: str
    cores: int
    system: str
    load: float
    date: str
    versions: dict[str, str]
    compiler: str
    seed: int
    budget_s: float


class Report(msgspec.Struct, frozen=True):
    """Everything that `aos bench --json` prints."""

    machine: Machine
    rows: tuple[Row, ...]
    skipped: tuple[Skipped, ...]


def figure(name: str, problem: str, metric: str, values: Sequence[float], unit: str) -> Row:
    """The mean of at least one value as a row."""
    error = statistics.stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0
    return Row(
        name=name, problem=problem, metric=metric, value=statistics.fmean(values), stderr=error, unit=unit
    )


def with_ratios(rows: Iterable[Row]) -> tuple[Row, ...]:
    """Our rows once for each other figure of the same problem and metric, and the others as they are."""
    rows = tuple(rows)
    compared: list[Row] = []
    for row in rows:
        others = [
            other
            for other in rows
            if row.name == OURS != other.name and (other.problem, other.metric) == (row.problem, row.metric)
        ]
        compared += [replace(row, against=other.name, ratio=row.value / other.value) for other in others]
        if not others:
            compared.append(row)
    return tuple(compared)


def this_machine(compiler: str, seed: int, budget_s: float) -> Machine:
    """The machine as it is now, and the settings of a run."""
    peers = {name: version for name in ("pomdp-py",) if (version := version_of(name))}
    return Machine(
        processor=_processor(),
        cores=len(os.sched_getaffinity(0)),
        system=f"{platform.system()} {platform.release()}, Python {platform.python_version()}",
        load=os.getloadavg()[0],
        date=datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        versions={"aos": __version__, **peers},
        compiler=compiler,
        seed=seed,
        budget_s=budget_s,
    )


def _processor() -> str:
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
