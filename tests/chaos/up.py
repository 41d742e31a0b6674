"""An `aos-up` with its mission, in a folder of its own, and what becomes of it."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from tests.processes import descendants, is_running

_ROOT = Path(__file__).resolve().parents[2]
BIN = Path(sys.executable).parent

KINDS = ("aos-up", "router", "registry", "middleware", "worker", "solver", "engine", "adapter")
"""The kinds of processes of a run."""

_COMMAND_LINES = {
    "router": r"-m aos_runtime\.router ",
    "registry": r"-m aos_registry ",
    "middleware": r"-m aos_middleware ",
    "worker": r"-m aos_middleware\.workers\.worker",
    "solver": r"-m aos_solver ",
    "engine": r"/model-[0-9a-f]+/",
    "adapter": r"-m aos_runtime\.adapters ",
}
_GUARD = r"aos_runtime[./]processes[./]guard"

_DEPLOY = """aos: 1
robot: tester
project: tiger
bundles: [tiger]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission:
  step_limit: {steps}
  activation_timeout_s: 20
  failure_limit: 1000
  set_aside_after: 1000
solver: {{simulations: 200, seed: {seed}}}
bind:
  /listen: {{python: "{robot}:listen"}}
  /open: {{python: "{robot}:open_door"}}
runs: runs
"""


class Process(NamedTuple):
    """A process, which is told from a later one of the same id by the time when it began."""

    pid: int
    begun: str
    words: str

    @classmethod
    def of(cls, pid: int) -> Process | None:
        try:
            stat = Path(f"/proc/{pid}/stat").read_text()
            words = Path(f"/proc/{pid}/cmdline").read_bytes()
        except OSError:
            return None
        return cls(
            pid, stat.rpartition(")")[2].split()[19], words.replace(b"\0", b" ").decode(errors="replace")
        )

    @property
    def is_left(self) -> bool:
        now = Process.of(self.pid)
        return now is not None and now.begun == self.begun and is_running(self.pid)


_SAMPLED = {
    "initial_belief:\n": (
        "state_variable: double hum\n\ninitial_belief:\nstate.hum = AOS.SampleUniform(0, 1);\n"
    ),
    "0.85 : 0.15": "0.7 + 0.2 * state.hum : 0.3 - 0.2 * state.hum",
}
"""The changes that make the tiger's belief one that cannot be enumerated: its loudness is a number."""

QUIET_S = 90.0
"""A mission that tells nothing for so long hangs."""


def write_deploy_file(folder: Path, seed: int, steps: int, *, is_sampled: bool = False):
    """Writes `tester.yaml` and its bundle: a tiger that is heard `steps` times."""
    (folder / "tiger").mkdir()
    for document in (_ROOT / "deploy/bundles/bench/tiger").iterdir():
        text = document.read_text()
        for plain, sampled in _SAMPLED.items() if is_sampled else ():
            text = text.replace(plain, sampled)
        (folder / "tiger" / document.name).write_text(text)
    robot = _ROOT / "tests/chaos/robot.py"
    (folder / "tester.yaml").write_text(_DEPLOY.format(robot=robot, seed=seed, steps=steps))


def compile_bundles(folder: Path):
    """Compiles both bundles into the cache, so that no mission waits for that."""
    for is_sampled in (False, True):
        place = folder / str(is_sampled)
        place.mkdir()
        write_deploy_file(place, 1, 1, is_sampled=is_sampled)
        subprocess.run(
            [BIN / "aos", "plan", place / "tiger", "--simulations", "10"], check=True, capture_output=True
        )


class Up:
    """A running `aos-up --json`, whose events come in time or not at all."""

    def __init__(
        self,
        folder: Path,
        *arguments: str | Path,
        moves_s: float = 0.05,
        environment: Mapping[str, str] | None = None,
    ):
        robot = {"AOS_MOTIONS": str(folder / "motions"), "AOS_MOVES_S": str(moves_s)}
        with (folder / "aos-up.log").open("a") as log:
            self.process = subprocess.Popen(
                [BIN / "aos-up", *arguments, "--json"],
                cwd=folder,
                env=os.environ | robot | (environment or {}),
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                start_new_session=True,
            )
        self.told = ""
        """All that it has told, as JSON."""
        self._events: queue.Queue[dict[str, object] | None] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.told += line
            with contextlib.suppress(json.JSONDecodeError):  # Whoever is killed leaves half a line.
                self._events.put(json.loads(line))
        self._events.put(None)

    def next(self, quiet_s: float = QUIET_S) -> dict[str, object] | None:
        """The next event, None at the end; queue.Empty if it hangs."""
        event = self._events.get(timeout=quiet_s)
        if event is None:
            self._events.put(None)
        return event

    def forget(self):
        """Passes over what was told up to now."""
        while not self._events.empty() and self.next() is not None:
            pass

    def until_decision(self) -> bool:
        while (event := self.next()) is not None:
            if event["event"] == "decision":
                return True
        return False

    def below(self) -> list[int]:
        try:
            return descendants(self.process.pid)
        except FileNotFoundError:
            return []

    def processes(self) -> set[Process]:
        """All processes of the run, as they are now."""
        found = (Process.of(pid) for pid in (self.process.pid, *self.below()))
        return {process for process in found if process is not None}

    def of_kind(self, kind: str) -> list[int]:
        """One process of a kind; of what runs behind a guard the process, not the guard."""
        if kind == "aos-up":
            return [self.process.pid]
        found = []
        for pid in self.below():
            try:
                line = Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            except OSError:
                continue
            if re.search(_COMMAND_LINES[kind], line) and not re.search(_GUARD, line):
                found.append(pid)
        return found[:1]

    def end(self):
        """Kills what is left of it."""
        pids = [self.process.pid, *self.below()]
        for pid in pids:
            send(pid, signal.SIGKILL)
        self.process.wait()


def send(pid: int, number: signal.Signals):
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, number)
