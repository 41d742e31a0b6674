"""The verdict on a mission that was disturbed: journal, exit code, motions, processes that are left."""

import asyncio
import json
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import msgspec
from tests.chaos.up import Process

from aos_deploy.history_check.files import check_run
from aos_deploy.history_check.replayed import replayed
from aos_deploy.runs.end import Verdict, account_of
from aos_deploy.runs.living import chosen_run

_LEFT_S = 15.0


class Disturbance(msgspec.Struct):
    """A disturbance of a kind, such as `solver killed`; the next decision came after `back_s`."""

    kind: str
    back_s: float | None = None


class Report(msgspec.Struct):
    """The outcome of a run. `faults` is empty where all went as promised; `name` runs it again."""

    name: str
    disturbances: list[Disturbance] = []
    ending: str = ""
    activations: int = 0
    beliefs: int = 0
    faults: list[str] = []


def judge(
    folder: Path, report: Report, status: int | None, processes: Iterable[Process], allowed: Iterable[str]
):
    """Adds to the report's faults what breaks a promise. The ending has to be one of `allowed`.

    Without a `status` aos-up has died after the end of the mission, and may have left no summary.
    """
    run = (folder / "runs" / "latest").resolve()
    verdict = account_of(run).verdict()
    report.ending = verdict.ending
    if report.ending not in allowed:
        report.faults.append(f"it ended as {report.ending} with exit code {status}: {verdict.remark}")
    report.faults += _faults_of_exit_code(run / "summary.json", verdict, status, has_space="" not in allowed)
    _check(run, report)
    report.faults += tracebacks(folder)
    until_s = time.monotonic() + _LEFT_S
    while (left := [process for process in processes if process.is_left]) and time.monotonic() < until_s:
        time.sleep(0.05)
    if left:
        report.faults.append(f"left: {'; '.join(process.words[:300] for process in left)}")
    motions = folder / "motions"
    lines = motions.read_text().splitlines() if motions.exists() else []
    begun = Counter(line.split()[1] for line in lines if line.startswith("begun"))
    report.activations = len(begun)
    report.faults += [f"{id} moved {count} times" for id, count in begun.items() if count > 1]


def _check(run: Path, report: Report):
    """Does what `aos check` does. A command for each of the runs would import all of it anew."""
    if chosen_run(run, None).is_running:
        report.faults.append("aos check: it goes on")
    again = asyncio.run(replayed(run, lambda _: None))
    report.faults += [
        f"aos check: {violation}" for violation in (*check_run(run).violations, *again.violations)
    ]
    report.beliefs = again.compared


def _faults_of_exit_code(
    summary: Path, verdict: Verdict, status: int | None, *, has_space: bool
) -> list[str]:
    """The disagreements of exit code, summary and journal. A full disk has no space for the latter's ends."""
    if status is not None and has_space and not summary.exists():
        return ["there is no summary"]
    codes = {status, verdict.exit_code if verdict.ending else None}
    if summary.exists():
        codes.add(json.loads(summary.read_text())["exit_code"])
    codes.discard(None)
    return [f"exit code, summary and journal disagree: {codes}"] if len(codes) > 1 else []


def tracebacks(folder: Path) -> list[str]:
    found = []
    for log in [folder / "aos-up.log", *folder.glob("runs/*/logs/*.log")]:
        text = log.read_text(errors="replace") if log.exists() else ""
        if "Traceback (most recent call last)" in text:
            after = text.rsplit("Traceback (most recent call last)", 1)[1].splitlines()
            last = next((line for line in after[1:] if line and not line.startswith(" ")), "")
            found.append(f"a traceback in {log.name}: {last}")
    return found
