"""One mission as a process, killed and frozen at random while it runs, and held against its journal."""

import queue
import random
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from tests.chaos.judged import Disturbance, Report, judge
from tests.chaos.up import KINDS, Process, Up, send, write_deploy_file

KILLS_OF_A_MISSION = 12
FREEZES_OF_A_MISSION = 3
_STEPS_OF_A_DISTURBANCE = 14
"""The steps that pass beside one, at most: a frozen registry stops no mission."""
_STOPPED_S = 3.0


def disturbed(folder: Path, name: str, seed: int, how: str) -> Report:
    """Runs a mission in an empty folder and disturbs it some times, in turn by each kind of processes.

    `how` is `kills` or `freezes`, of 1 s or 6 s. Every fourth mission has a sampled belief; there the engine
    is killed every second time.
    """
    chance = random.Random(f"{how} {seed}")
    is_sampled = seed % 4 == 3
    times = KILLS_OF_A_MISSION if how == "kills" else FREEZES_OF_A_MISSION
    report = Report(name)
    write_deploy_file(folder, seed, times * _STEPS_OF_A_DISTURBANCE, is_sampled=is_sampled)
    processes: set[Process] = set()
    up = Up(folder, "tester.yaml")
    try:
        for kind in _kinds(chance, times, is_sampled):
            for _ in range(chance.randint(1, 2)):
                up.until_decision()
            time.sleep(chance.uniform(0.0, 0.15))
            processes |= up.processes()
            victims = up.of_kind(kind)
            if not victims or up.process.poll() is not None:
                continue
            up = _disturb(
                folder, up, kind, victims, 0.0 if how == "kills" else chance.choice((1.0, 6.0)), report
            )
            processes |= up.processes()
        _let_it_end(folder, up)
        status = up.process.wait(60.0)
    except (queue.Empty, subprocess.TimeoutExpired):
        report.faults.append("it hangs")
        up.end()
        return report
    judge(folder, report, status, processes, allowed=("step_limit", "cancelled"))
    return report


def _kinds(chance: random.Random, times: int, is_sampled: bool) -> list[str]:
    kinds: list[str] = []
    while len(kinds) < times:
        kinds += chance.sample(KINDS, len(KINDS))
    if is_sampled:
        kinds[::2] = ["engine"] * len(kinds[::2])
    return kinds[:times]


def _disturb(folder: Path, up: Up, kind: str, victims: list[int], frozen_s: float, report: Report) -> Up:
    disturbance = Disturbance(f"{kind} frozen {frozen_s:g} s" if frozen_s else f"{kind} killed")
    report.disturbances.append(disturbance)
    for victim in victims:
        send(victim, signal.SIGSTOP if frozen_s else signal.SIGKILL)
    begun_s = time.monotonic()
    up.forget()
    if frozen_s:
        time.sleep(frozen_s)
        for victim in victims:
            send(victim, signal.SIGCONT)
    elif kind == "aos-up":
        up.process.wait()
        up = Up(folder, "--resume")
    if up.until_decision():
        disturbance.back_s = time.monotonic() - begun_s
    return up


def _let_it_end(folder: Path, up: Up):
    if up.until_decision():
        send(up.process.pid, signal.SIGINT)
    while up.next() is not None:
        pass


def cancelled(folder: Path, name: str, seed: int) -> Report:
    """Kills an aos-up in mid-motion: the adapter has to stop the robot. The motion would take a minute."""
    report = Report(name)
    write_deploy_file(folder, seed, steps=3)
    up = Up(folder, "tester.yaml", moves_s=60.0)
    motions = folder / "motions"
    if not _comes(lambda: motions.exists() and "begun" in motions.read_text(), 60.0):
        report.faults.append("nothing moved")
        up.end()
        return report
    time.sleep(random.Random(seed).uniform(0.0, 0.5))
    pids = [up.process.pid, *up.below()]
    begun_s = time.monotonic()
    send(up.process.pid, signal.SIGKILL)
    up.process.wait()
    disturbance = Disturbance("aos-up killed in mid-motion: stopped")
    report.disturbances.append(disturbance)
    if _comes(lambda: "cancelled" in motions.read_text(), _STOPPED_S):
        disturbance.back_s = time.monotonic() - begun_s
    else:
        report.faults.append(f"the robot was not stopped within {_STOPPED_S:g} s")
        for pid in pids:
            send(pid, signal.SIGKILL)
    return report


def _comes(holds: Callable[[], bool], within_s: float) -> bool:
    until_s = time.monotonic() + within_s
    while not holds():
        if time.monotonic() > until_s:
            return False
        time.sleep(0.01)
    return True
