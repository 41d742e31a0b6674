"""An adapter on another host, behind a bad link: a network namespace with an SSH server of its own."""

import getpass
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from ..counters import counting
from .wire import Wire, wire

_PORT = 2222
_PATIENCE_S = 120.0
_START_S = 900.0
"""The first mission on a busy machine compiles its engine."""
_STEPS = 100_000

_FILES = {
    **{f"documents/{name}": text for name, text in counting("far").items()},
    "far_robot.py": """import asyncio
from pathlib import Path

from aos_runtime.adapters import Adapter


class Robot(Adapter):
    version = "1"

    def __init__(self, host):
        self.host = host

    async def start(self):
        await self.host.serve("/step")

    async def close(self):
        pass

    async def call(self, call):
        with Path("moved").open("a") as file:
            file.write(f"{call.id}\\n")
        await asyncio.sleep(0.3)
        return {}
""",
    "far.yaml": """aos: 1
robot: far
bundles: [documents]
mission: {step_limit: STEPS, failure_limit: 1000, set_aside_after: 1000, hold_s: 300}
solver: {simulations: 20}
adapters:
  arm: {command: [PYTHON, -m, aos_runtime.adapters, "far_robot.py:Robot"], host: robot@arm, folder: FOLDER}
bind: {/step: arm}
runs: runs
""",
}


class Cut(NamedTuple):
    """A cut of so many seconds, and what came of it: when the mission held, and when it went on after the
    end; None where it did not."""

    cut_s: float
    held_s: float | None
    went_on_s: float | None


def is_possible() -> bool:
    """Says whether namespaces, their devices and an SSH server can be had here."""
    programs = all(
        shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin") for name in ("ip", "sshd", "ssh")
    )
    return programs and os.getuid() == 0 and Path("/dev/net/tun").exists()


class FarMission:
    """A mission whose robot is in the namespace, at the other end of `link`."""

    def __init__(self, folder: Path, process: subprocess.Popen[str], link: Wire):
        self.link = link
        self._folder = folder
        self._process = process
        self._events: list[tuple[float, dict[str, Any]]] = []
        self._news = threading.Condition()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def cut(self, cut_s: float) -> Cut:
        """Cuts the link for so long. The mission has to hold, unless it is over before."""
        self._until(lambda event: event.get("phase") == "acting", time.monotonic())
        down_s = time.monotonic()
        self.link.is_cut = True
        held_s = self._until(_is_held, down_s, min(cut_s, _PATIENCE_S))
        time.sleep(max(0.0, down_s + cut_s - time.monotonic()))
        up_s = time.monotonic()
        self.link.is_cut = False
        went_on_s = self._until(_is_observed, up_s)
        return Cut(
            cut_s,
            None if held_s is None else held_s - down_s,
            None if went_on_s is None else went_on_s - up_s,
        )

    def until_moved(self, times: int) -> bool:
        """Waits until the robot has moved so many times more; False where it stops to."""
        wanted = len(self.moved) + times
        while len(self.moved) < wanted:
            if self._until(_is_observed, time.monotonic()) is None:
                return False
        return True

    def holds_since(self, since_s: float) -> int:
        """The number of times that the mission has held since then, in time.monotonic()."""
        with self._news:
            return sum(at_s >= since_s and _is_held(event) for at_s, event in self._events)

    def told_since(self, since_s: float) -> list[str]:
        """The changes of the adapter's process since then, each with its time after it."""
        with self._news:
            return [
                f"{at_s - since_s:.2f} s {event['state']} {event['detail']}".strip()
                for at_s, event in self._events
                if at_s >= since_s and event.get("service") == "arm"
            ]

    @property
    def has_ended(self) -> bool:
        """True where it should go on and does not."""
        return self._process.poll() is not None

    @property
    def moved(self) -> list[str]:
        return (self._folder / "moved").read_text().split()

    def _until(self, is_it: Any, since_s: float, timeout_s: float = _PATIENCE_S) -> float | None:
        """The time of the first such event since then."""

        def found() -> float | None:
            return next((at_s for at_s, event in self._events if at_s >= since_s and is_it(event)), None)

        with self._news:
            self._news.wait_for(lambda: found() is not None or self.has_ended, timeout_s)
            return found()

    def _read(self):
        assert self._process.stdout is not None
        with suppress(ValueError):  # The output is closed when the mission is ended.
            for line in self._process.stdout:
                event = json.loads(line)
                with self._news:
                    self._events.append((time.monotonic(), event))
                    self._news.notify_all()


def _is_held(event: dict[str, Any]) -> bool:
    return event.get("phase") == "holding"


def _is_observed(event: dict[str, Any]) -> bool:
    return (event.get("outcome") or {}).get("status") == "observed"


@contextmanager
def far_mission(folder: Path, number: int = 0) -> Iterator[FarMission]:
    """The mission, once its robot has moved; it is ended with the block, and so is the namespace.

    Missions of different numbers, up to 63, can be played at the same time.
    """
    here, there = (f"10.213.77.{4 * number + end}" for end in (1, 2))
    namespace = f"aosfar{number}"
    python = str(Path(sys.executable))
    for name, text in _FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        text = text.replace("STEPS", str(_STEPS)).replace("PYTHON", python).replace("FOLDER", str(folder))
        (folder / name).write_text(text)
    with wire(namespace, here, there) as link, _server(folder, namespace, there) as programs:
        environment = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
        command = [Path(sys.executable).with_name("aos-up"), "far.yaml", "--json"]
        with (folder / "aos-up.log").open("w") as log:
            process = subprocess.Popen(
                command, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE, stderr=log
            )
        with process:
            mission = FarMission(folder, process, link)
            try:
                if mission._until(_is_observed, 0.0, _START_S) is None:
                    raise RuntimeError((folder / "aos-up.log").read_text())
                yield mission
            finally:
                process.terminate()


@contextmanager
def _server(folder: Path, namespace: str, there: str) -> Iterator[str]:
    """An SSH server in the namespace; gives the folder of an `ssh` that reaches it as robot@arm."""
    for name in ("host", "user"):
        command = ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(folder / name)]
        subprocess.run(command, check=True)
    (folder / "sshd_config").write_text(
        f"ListenAddress {there}:{_PORT}\nHostKey {folder}/host\nAuthorizedKeysFile {folder}/user.pub\n"
        "PidFile none\nStrictModes no\nUsePAM no\nPasswordAuthentication no\n"
    )
    kind, key, _ = (folder / "host.pub").read_text().split(" ", 2)
    (folder / "known").write_text(f"[{there}]:{_PORT} {kind} {key}\n")
    (folder / "ssh_config").write_text(
        f"Host arm\n HostName {there}\n Port {_PORT}\n IdentityFile {folder}/user\n"
        f" IdentitiesOnly yes\n UserKnownHostsFile {folder}/known\n"
    )
    Path("/run/sshd").mkdir(exist_ok=True)
    programs = folder / "bin"
    programs.mkdir()
    ssh = shutil.which("ssh")
    (programs / "ssh").write_text(
        f'#!/bin/sh\nexec {ssh} -F {folder}/ssh_config -l {getpass.getuser()} "$@"\n'
    )
    (programs / "ssh").chmod(0o755)
    sshd = shutil.which("sshd", path=f"{os.environ['PATH']}:/usr/sbin")
    command = ["ip", "netns", "exec", namespace, str(sshd), "-D", "-e", "-f", str(folder / "sshd_config")]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as server:
        try:
            time.sleep(0.5)
            yield str(programs)
        finally:
            server.terminate()
