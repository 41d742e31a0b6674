"""Many runs, some at a time: which there are, how they go, and the table of what became of them."""

import shutil
import statistics
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from tests.chaos.disturbed import FREEZES_OF_A_MISSION, KILLS_OF_A_MISSION, cancelled, disturbed
from tests.chaos.failing import WRITES, failing, refused
from tests.chaos.judged import Report

from aos_deploy.terminal import progress
from aos_runtime.failpoints import FAILPOINTS

PARTS = {
    "kills": "SIGKILLs, 12 in a mission, of all processes",
    "freezes": "freezes of 1 s or 6 s, 3 in a mission",
    "failpoints": "runs at each failpoint",
    "full": "times that the disk is full at each write",
    "readonly": "times that it is read-only at each write",
    "cancels": "aos-up killed in mid-motion",
}
"""The parts of a campaign, each with what is counted."""


def names_of(counts: Mapping[str, int], seed: int) -> list[str]:
    """The names of the runs with so many of each part. Run a name again with `--again NAME`."""
    missions = {
        "kills": -(-counts["kills"] // KILLS_OF_A_MISSION),
        "freezes": -(-counts["freezes"] // FREEZES_OF_A_MISSION),
    }
    names = [f"{how}:{seed + number}" for how, count in missions.items() for number in range(count)]
    for number in range(counts["failpoints"]):
        names += [f"failpoint:{place}:{seed + number}" for place in FAILPOINTS]
    for how in ("full", "readonly"):
        names += [f"{how}:{place}:{time}" for _ in range(counts[how]) for place, time in WRITES]
    names += [f"cancel:{seed + number}" for number in range(counts["cancels"])]
    return names


def report_of(name: str, keep: Path | None = None) -> Report:
    """Runs one again, or for the first time; the folder of one that breaks a promise is kept there."""
    folder = Path(tempfile.mkdtemp(prefix="aos-chaos-"))
    what, *more = name.split(":")
    try:
        report = _run(folder, name, what, more)
    except Exception as error:
        report = Report(name, faults=[f"{type(error).__name__}: {error}"])
    if report.faults and keep is not None:
        shutil.copytree(folder, keep / name.replace(":", "-"), symlinks=True, dirs_exist_ok=True)
    shutil.rmtree(folder, ignore_errors=True)
    return report


def _run(folder: Path, name: str, what: str, more: list[str]) -> Report:
    if what == "failpoint":
        return failing(folder, name, more[0], int(more[1]))
    if what in ("full", "readonly"):
        return refused(folder, name, more[0], int(more[1]), what)
    if what == "cancel":
        return cancelled(folder, name, int(more[0]))
    return disturbed(folder, name, int(more[0]), what)


def run_all(names: list[str], jobs: int, keep: Path | None) -> Iterator[Report]:
    """Runs all of them, so many at a time; yields each report when it is there."""
    with ThreadPoolExecutor(jobs) as pool, progress() as shown:
        task = shown.add_task("runs", total=len(names))
        for done in as_completed([pool.submit(report_of, name, keep) for name in names]):
            report = done.result()
            shown.advance(task)
            if report.faults:
                print(f"{report.name}: {'; '.join(report.faults)}", file=sys.stderr, flush=True)
            yield report


def table(reports: list[Report]) -> str:
    """The table of disturbances: how often, and how soon the next decision came."""
    back_s: dict[str, list[float | None]] = defaultdict(list)
    for report in reports:
        for disturbance in report.disturbances:
            back_s[disturbance.kind].append(disturbance.back_s)
    lines = ["| disturbed | times | next decision after | 95 % | most |", "|---|---:|---:|---:|---:|"]
    for kind, times in sorted(back_s.items()):
        lines.append(f"| {kind} | {len(times)} | {' | '.join(_times([s for s in times if s is not None]))} |")
    good = sum(not report.faults for report in reports)
    activations = sum(report.activations for report in reports)
    beliefs = sum(report.beliefs for report in reports)
    lines.append(
        f"\n{good} of {len(reports)} runs kept what is promised; {activations} activations; "
        f"{beliefs} beliefs had the digest of their replay."
    )
    lines += [f"again: python -m tests.chaos --again {report.name}" for report in reports if report.faults]
    return "\n".join(lines)


def _times(back_s: list[float]) -> list[str]:
    if not back_s:
        return ["", "", ""]
    back_s = sorted(back_s)
    late = back_s[min(int(0.95 * len(back_s)), len(back_s) - 1)]
    return [f"{seconds:.2f} s" for seconds in (statistics.median(back_s), late, back_s[-1])]
