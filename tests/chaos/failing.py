import queue
import random
import signal
import subprocess
import time
from pathlib import Path

from tests.chaos.judged import Disturbance, Report, judge
from tests.chaos.up import Process, Up, send, write_deploy_file

from aos_deploy.runs.end import account_of
from aos_runtime.failpoints import EXIT_STATUS

_STEPS = 5
_FROZEN_S = 6.0
_WRITES = {
    "journal.begun": 1,
    "journal.mission": 4,
    "journal.decision": 4,
    "journal.intended": 3,
    "journal.outcome": 3,
    "middleware.started": 2,
    "middleware.ended": 2,
    "adapter.started": 2,
    "adapter.ended": 2,
    "up.record": 1,
    "up.summary": 1,
}
WRITES = tuple((f"{place}.before", time) for place, times in _WRITES.items() for time in range(1, times + 1))
"""The writes at which a disk is full or read-only: each place with the time when it is come to."""


def failing(folder: Path, name: str, place: str, seed: int) -> Report:
    """A mission of which one process is killed, exits or is frozen at a failpoint; it has to be completed.

    An `aos-up` that dies is resumed, or started again where its run had not begun.
    """
    chance = random.Random(f"{place} {seed}")
    action = chance.choice(("kill", "kill", "exit", "freeze"))
    time_there = chance.randint(1, _times_reached(place))
    report = Report(name)
    write_deploy_file(folder, seed, _STEPS)
    failed = folder / "failed"
    environment = {"AOS_FAILPOINT": f"{place}:{action}:{time_there}", "AOS_FAILPOINT_DONE": str(failed)}
    up = Up(folder, "tester.yaml", environment=environment)
    processes: set[Process] = set()
    try:
        while True:
            processes |= _until_ended(up)
            status: int | None = up.process.wait(30.0)
            if status not in (-signal.SIGKILL, EXIT_STATUS):
                break
            if _is_over(folder):
                status = None
                break
            up = Up(folder, *_to_go_on(folder))
    except (queue.Empty, subprocess.TimeoutExpired):
        report.faults.append("it hangs")
        up.end()
        return report
    if not failed.exists():
        report.faults.append(f"{place} was not reached for time {time_there}")
    report.disturbances.append(Disturbance(f"{place} {action}"))
    judge(folder, report, status, processes, allowed=("step_limit",))
    return report


def _times_reached(place: str) -> int:
    """Returns how often a mission surely comes to a failpoint in one process."""
    once = ("journal.begun", "solver.engine", "up.record", "up.summary")
    return 1 if place.startswith(once) else 2


def _is_over(folder: Path) -> bool:
    """Says whether the mission had ended when its aos-up died."""
    run = folder / "runs" / "latest"
    return run.exists() and account_of(run).verdict().ending == "step_limit"


def _to_go_on(folder: Path) -> list[str]:
    """The arguments for what a dead aos-up has left: a run to take up, or none."""
    return ["--resume"] if (folder / "runs" / "latest").exists() else ["tester.yaml"]


def _until_ended(up: Up) -> set[Process]:
    """Reads all events, and lets an aos-up that was frozen go on after a while; returns all its processes."""
    processes: set[Process] = set()
    quiet_since_s = time.monotonic()
    while True:
        processes |= up.processes()
        try:
            if up.next(quiet_s=_FROZEN_S) is None:
                return processes
            quiet_since_s = time.monotonic()
        except queue.Empty:
            send(up.process.pid, signal.SIGCONT)
            if time.monotonic() - quiet_since_s > 90.0:
                raise


def refused(folder: Path, name: str, place: str, time_there: int, how: str) -> Report:
    """A mission whose disk refuses one write, and those of the process from then on: it ends with AOS701.

    `how` is `full` or `readonly`.
    """
    report = Report(name)
    write_deploy_file(folder, 1, _STEPS)
    failed = folder / "failed"
    environment = {"AOS_FAILPOINT": f"{place}:{how}:{time_there}", "AOS_FAILPOINT_DONE": str(failed)}
    up = Up(folder, "tester.yaml", environment=environment)
    try:
        processes = _until_ended(up)
        status = up.process.wait(30.0)
    except (queue.Empty, subprocess.TimeoutExpired):
        report.faults.append("it hangs")
        up.end()
        return report
    report.disturbances.append(Disturbance(f"{place} {how}"))
    if not failed.exists():
        report.faults.append(f"{place} was not reached for time {time_there}")
        return report
    told = up.told + (folder / "aos-up.log").read_text()
    if "AOS701" not in told:
        report.faults.append(f"it ended with exit code {status} without AOS701: {told[-500:]}")
    motions = folder / "motions"
    late = [
        line
        for line in (motions.read_text().splitlines() if motions.exists() else [])
        if line.startswith("begun") and float(line.split()[2]) > failed.stat().st_mtime + 0.05
    ]
    if late:
        report.faults.append(f"{len(late)} motions began after the disk was {how}")
    if place != "up.summary.before" and (folder / "runs" / "latest").exists():
        judge(folder, report, status, processes, allowed=("fault", "not_started", "step_limit", ""))
    return report
