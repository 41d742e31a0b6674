"""One mission as a process, disturbed while it runs, and held against its journal afterwards."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import random
import re
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import msgspec
from tests.processes import descendants, is_running

__all__ = ["KINDS", "Disturbance", "Report", "cancelled_after_s", "disturbed_mission"]

_ROOT = Path(__file__).resolve().parents[2]
_BIN = Path(sys.executable).parent

KINDS = ("aos-up", "router", "registry", "middleware", "worker", "solver", "engine", "adapter")
"""The kinds of processes of a run."""

_COMMAND_LINES = {
    "router": r"-m aos_runtime\.router ",
    "registry": r"-m aos_registry ",
    "middleware": r"-m aos_middleware ",
    "worker": r"-m aos_middleware\.worker",
    "solver": r"-m aos_solver ",
    "engine": r"/model-[0-9a-f]+/",
    "adapter": r"-m aos_runtime\.adapters ",
}
_GUARD = r"aos_runtime[./]guard"

_DEPLOY = """aos: 1
robot: tester
project: tiger
bundles: [{bundle}]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission:
  step_limit: {steps}
  activation_timeout_s: 20
  failure_limit: 1000
  set_aside_after: 1000
solver: {{time_s: 0.05, seed: {seed}}}
bind:
  /listen: {{python: "{robot}:listen"}}
  /open: {{python: "{robot}:open_door"}}
runs: runs
"""

_QUIET_S = 90.0
"""A mission that tells nothing for so long hangs."""


class Disturbance(msgspec.Struct):
    """A process that was killed, or frozen for `frozen_s`; the next decision came after `back_s`."""

    kind: str
    frozen_s: float = 0.0
    back_s: float | None = None


class Report(msgspec.Struct):
    """The outcome of a mission. `faults` is empty where all went as promised."""

    seed: int
    disturbances: list[Disturbance]
    ending: str = ""
    activations: int = 0
    faults: list[str] = []


class Up:
    """A running `aos-up --json`, whose events come in time or not at all."""

    def __init__(self, folder: Path, *arguments: str | Path, moves_s: float = 0.15) -> None:
        self._log = (folder / "aos-up.log").open("a")
        self.process = subprocess.Popen(
            [_BIN / "aos-up", *arguments, "--json"],
            cwd=folder,
            env=os.environ | {"AOS_MOTIONS": str(folder / "motions"), "AOS_MOVES_S": str(moves_s)},
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
            start_new_session=True,
        )
        self._events: queue.Queue[dict[str, object] | None] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._events.put(json.loads(line))
        self._events.put(None)

    def next(self) -> dict[str, object] | None:
        """The next event, None at the end; queue.Empty if it hangs."""
        event = self._events.get(timeout=_QUIET_S)
        if event is None:
            self._events.put(None)
        return event

    def forget(self) -> None:
        """Passes over what was told up to now."""
        while not self._events.empty() and self.next() is not None:
            pass

    def until_decision(self) -> bool:
        """Returns whether another decision comes."""
        while (event := self.next()) is not None:
            if event["event"] == "decision":
                return True
        return False

    def below(self) -> list[int]:
        try:
            return descendants(self.process.pid)
        except FileNotFoundError:
            return []


def disturbed_mission(
    folder: Path, seed: int, kinds: tuple[str, ...], times: int, frozen: float, steps: int
) -> Report:
    """Runs a mission of so many steps in an empty folder and disturbs it so many times.

    A disturbance is a freeze with the probability `frozen`, of 1 s or 6 s, and else a SIGKILL.
    """
    chance = random.Random(seed)
    report = Report(seed, [])
    _write_deploy_file(folder, seed, steps)
    pids: set[int] = set()
    up = Up(folder, "tester.yaml")
    try:
        for _ in range(times):
            for _ in range(chance.randint(1, 3)):
                if not up.until_decision():
                    break
            time.sleep(chance.uniform(0.0, 0.4))
            pids |= {up.process.pid, *up.below()}
            disturbance = Disturbance(chance.choice(kinds))
            victims = _of_kind(disturbance.kind, up)
            if not victims:
                continue
            report.disturbances.append(disturbance)
            up.forget()
            begun_s = time.monotonic()
            if chance.random() < frozen:
                disturbance.frozen_s = chance.choice((1.0, 6.0))
                up = _freeze(folder, up, disturbance, victims)
            else:
                up = _kill(folder, up, disturbance, victims)
            if up.until_decision():
                disturbance.back_s = time.monotonic() - begun_s
            pids |= {up.process.pid, *up.below()}
        while up.next() is not None:
            pass
        status = up.process.wait(30.0)
    except (queue.Empty, subprocess.TimeoutExpired):
        report.faults.append("it hangs")
        os.kill(up.process.pid, signal.SIGKILL)
        up.process.wait()
        return report
    _judge(folder, report, status, pids)
    return report


def _write_deploy_file(folder: Path, seed: int, steps: int) -> None:
    text = _DEPLOY.format(
        bundle=_ROOT / "deploy/bundles/bench/tiger",
        robot=_ROOT / "tests/chaos/robot.py",
        seed=seed,
        steps=steps,
    )
    (folder / "tester.yaml").write_text(text)


def cancelled_after_s(folder: Path, seed: int) -> float | None:
    """Kills an aos-up in mid-motion; returns when the adapter has stopped the robot, None if it does not.

    The motion would take a minute.
    """
    _write_deploy_file(folder, seed, steps=3)
    up = Up(folder, "tester.yaml", moves_s=60.0)
    motions = folder / "motions"
    if not _comes(lambda: motions.exists() and "begun" in motions.read_text()):
        up.process.kill()
        return None
    time.sleep(random.Random(seed).uniform(0.0, 0.5))
    begun_s = time.monotonic()
    os.kill(up.process.pid, signal.SIGKILL)
    up.process.wait()
    is_cancelled = _comes(lambda: "cancelled" in motions.read_text())
    return time.monotonic() - begun_s if is_cancelled else None


def _comes(holds: Callable[[], bool]) -> bool:
    until_s = time.monotonic() + 60.0
    while not holds():
        if time.monotonic() > until_s:
            return False
        time.sleep(0.01)
    return True


def _kill(folder: Path, up: Up, disturbance: Disturbance, victims: list[int]) -> Up:
    for victim in victims:
        _signal(victim, signal.SIGKILL)
    if disturbance.kind != "aos-up":
        return up
    up.process.wait()
    return Up(folder, "--resume")


def _freeze(folder: Path, up: Up, disturbance: Disturbance, victims: list[int]) -> Up:
    for victim in victims:
        _signal(victim, signal.SIGSTOP)
    time.sleep(disturbance.frozen_s)
    for victim in victims:
        _signal(victim, signal.SIGCONT)
    return up


def _of_kind(kind: str, up: Up) -> list[int]:
    """One process of a kind below an aos-up; of what runs behind a guard the process, not the guard."""
    if kind == "aos-up":
        return [up.process.pid]
    found = []
    for pid in up.below():
        try:
            line = Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if re.search(_COMMAND_LINES[kind], line) and not re.search(_GUARD, line):
            found.append(pid)
    return found[:1]


def _signal(pid: int, number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, number)


def _judge(folder: Path, report: Report, status: int, pids: set[int]) -> None:
    run = (folder / "runs" / "latest").resolve()
    summary = json.loads((run / "summary.json").read_text())
    report.ending = summary["ending"]
    if (status, report.ending) != (6, "step_limit"):
        report.faults.append(f"it ended as {report.ending} with exit code {status}: {summary['remark']}")
    if summary["exit_code"] != status:
        report.faults.append(f"the summary says {summary['exit_code']}, the exit code is {status}")
    checked = subprocess.run([_BIN / "aos", "check", run], capture_output=True, text=True, check=False)
    if checked.returncode != 0:
        report.faults.append(f"aos check: {checked.stdout.strip()}")
    until_s = time.monotonic() + 10.0
    while (left := [pid for pid in pids if is_running(pid)]) and time.monotonic() < until_s:
        time.sleep(0.05)
    if left:
        report.faults.append(f"{len(left)} processes are left")
    begun = Counter(
        line.split()[1] for line in (folder / "motions").read_text().splitlines() if line.startswith("begun")
    )
    report.activations = len(begun)
    report.faults += [f"{id} moved {count} times" for id, count in begun.items() if count > 1]
