"""A small mission on a real system, which waits in its midst until somebody has tried what he wants to."""

import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import zenoh

from aos_deploy.runs.directory import RunDirectory
from aos_runtime.bus.credentials import credential_of_run

from ..counters import counting
from .routed import opened

ROBOT = "cell"
STEPS = 8
"""The mission's steps. In the one before the last it waits."""
_PATIENCE_S = 600.0

_FILES = {
    **{f"documents/{name}": text for name, text in counting("cell").items()},
    "robot.py": """import asyncio
from pathlib import Path

MOVED = Path(__file__).with_name("moved")


def moved(what):
    with MOVED.open("a") as file:
        file.write(what + "\\n")
    return len(MOVED.read_text().split())


async def step(call):
    if moved("step") == STEPS - 1:
        MOVED.with_name("waits").touch()
        while not MOVED.with_name("go").exists():
            await asyncio.sleep(0.05)
    return {}


async def open_door(call):
    moved("open")
    return {}
""",
    "cell.yaml": """aos: 1
robot: cell
bundles: [documents]
mission: {step_limit: 100, activation_timeout_s: 3600}
solver: {simulations: 20}
adapters:
  hand: {external: "", credential: hand.password}
bind:
  /step: {python: "robot.py:step"}
  /open: {python: "robot.py:open_door"}
  /hand: hand
runs: runs
""",
}


class Cell:
    """The mission that waits. `sessions` of others are closed with it."""

    def __init__(self, folder: Path, process: subprocess.Popen[str]):
        self.folder = folder
        self.run = (folder / "runs" / "latest").resolve()
        self.record = RunDirectory(self.run).read_record()
        self._process = process
        self._sessions: dict[str, zenoh.Session] = {}
        self.exit_code: int | None = None

    @property
    def mission(self) -> str:
        return self.run.name

    def session(self, user: str) -> zenoh.Session:
        if user not in self._sessions:
            self._sessions[user] = opened(self.record.endpoint, credential_of_run(self.run, user))
        return self._sessions[user]

    def log(self, name: str) -> str:
        """A service's log by now, or what `aos-up` has said."""
        if name == "aos-up":
            return (self.folder / "aos-up.log").read_text(errors="replace")
        return (self.run / "logs" / f"{name}.log").read_text(errors="replace")

    @property
    def moved(self) -> list[str]:
        return (self.folder / "moved").read_text().split()

    def go_on(self):
        """Lets the mission end."""
        for session in self._sessions.values():
            session.close()
        (self.folder / "go").touch()
        self.exit_code = self._process.wait(_PATIENCE_S)

    @property
    def summary(self) -> dict[str, Any]:
        summary: dict[str, Any] = json.loads((self.run / "summary.json").read_text())
        return summary


@contextmanager
def cell(folder: Path) -> Iterator[Cell]:
    """The mission in an empty folder, once it waits; it is ended with the block."""
    for name, text in _FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text.replace("STEPS", str(STEPS)))
    command = [Path(sys.executable).parent / "aos-up", "cell.yaml", "--plain"]
    with (folder / "aos-up.log").open("w") as log:
        process = subprocess.Popen(command, cwd=folder, text=True, stdout=log, stderr=log)
    with process:
        try:
            _until_it_waits(folder, process)
            yield Cell(folder, process)
        finally:
            (folder / "go").touch()
            if process.poll() is None:
                process.terminate()


def _until_it_waits(folder: Path, process: subprocess.Popen[str]):
    look = threading.Event()
    while not (folder / "waits").exists():
        if process.poll() is not None:
            raise RuntimeError((folder / "aos-up.log").read_text())
        look.wait(0.05)
