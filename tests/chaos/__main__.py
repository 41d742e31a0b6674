"""Runs disturbed missions and prints a table by what was disturbed."""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from tests.chaos.disturbed import KINDS, Disturbance, Report, cancelled_after_s, disturbed_mission


def main() -> int:
    """Exit code 0 where every mission kept what is promised."""
    parser = argparse.ArgumentParser(prog="python -m tests.chaos", description=__doc__)
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--times", type=int, default=4, help="disturbances of a mission")
    parser.add_argument("--steps", type=int, default=30, help="steps of a mission")
    parser.add_argument("--frozen", type=float, default=0.2, help="share of freezes among the disturbances")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument(
        "--cancels", type=int, default=0, help="only kill aos-up in mid-motion, so many times"
    )
    options = parser.parse_args()
    if options.cancels:
        return _cancels(options.cancels, options.seed)
    reports = []
    for seed in range(options.seed, options.seed + options.missions):
        with tempfile.TemporaryDirectory(prefix="aos-chaos-") as folder:
            report = disturbed_mission(
                Path(folder), seed, tuple(options.kinds), options.times, options.frozen, options.steps
            )
        reports.append(report)
        what = ", ".join(_text(disturbance) for disturbance in report.disturbances)
        print(f"{seed}: {'; '.join(report.faults) or report.ending}  ({what})", flush=True)
    print(_table(reports))
    return int(any(report.faults for report in reports))


def _cancels(times: int, seed: int) -> int:
    """Exit code 0 where the robot was stopped each time within 3 s of the death of its aos-up."""
    after_s = []
    for number in range(seed, seed + times):
        with tempfile.TemporaryDirectory(prefix="aos-chaos-", ignore_cleanup_errors=True) as folder:
            took_s = cancelled_after_s(Path(folder), number)
        print(f"{number}: {'not stopped' if took_s is None else f'stopped after {took_s:.2f} s'}", flush=True)
        after_s.append(took_s)
    good = [took_s for took_s in after_s if took_s is not None and took_s <= 3.0]
    most = f", the last after {max(good):.2f} s" if good else ""
    print(f"{len(good)} of {times} robots were stopped within 3 s of the death of aos-up in mid-motion{most}")
    return int(len(good) < times)


def _text(disturbance: Disturbance) -> str:
    how = f" frozen {disturbance.frozen_s:g} s" if disturbance.frozen_s else ""
    back = "" if disturbance.back_s is None else f" {disturbance.back_s:.2f} s"
    return f"{disturbance.kind}{how}{back}"


def _table(reports: list[Report]) -> str:
    by_kind: dict[str, list[Disturbance]] = defaultdict(list)
    for report in reports:
        for disturbance in report.disturbances:
            how = f", frozen {disturbance.frozen_s:g} s" if disturbance.frozen_s else ""
            by_kind[f"{disturbance.kind}{how}"].append(disturbance)
    lines = ["", "| disturbed | times | next decision after | 95 % | most |", "|---|---:|---:|---:|---:|"]
    for kind in sorted(by_kind):
        back_s = sorted(each.back_s for each in by_kind[kind] if each.back_s is not None)
        lines.append(f"| {kind} | {len(by_kind[kind])} | {' | '.join(_times(back_s))} |")
    good = sum(not report.faults for report in reports)
    motions = sum(report.activations for report in reports)
    lines.append(f"\n{good} of {len(reports)} missions kept what is promised; {motions} activations.")
    return "\n".join(lines)


def _times(back_s: list[float]) -> list[str]:
    if not back_s:
        return ["", "", ""]
    late = back_s[min(int(0.95 * len(back_s)), len(back_s) - 1)]
    return [f"{seconds:.2f} s" for seconds in (statistics.median(back_s), late, back_s[-1])]


if __name__ == "__main__":
    sys.exit(main())
