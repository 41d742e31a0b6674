"""One attempt: documents with hostile code in a command or a mission, and what came of it."""

from __future__ import annotations

import os
import secrets
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tests.hostile.cases import COMPILED, MAPPINGS, MODELS
from tests.kept_cache import link_engines

from .counters import counting

__all__ = ["TOLD_S", "WAYS", "Attempt", "Playground", "attempts"]

WAYS = ("lint", "push", "mission")
TOLD_S = 15.0
"""The time within which a place is to be told on a machine that does nothing else."""
_HEARD_S = 8 * TOLD_S
_COMMAND_S = 240.0
_LINES = {"model": "reach.sd:", "compiler": "reach.sd:", "mapping": "reach.am:10:"}
"""The words that tell the place. Code that goes on for ever is told at its head, other code at its line."""
_DID_NOT_END = "(it did not end when it was told to)"
_HARMLESS = ("prints 1 GB",)
"""This is no fault: what is printed beyond the limit is dropped."""

_RESULT = """local_variable: value
from_ros_service_response: true
code:
CODE
"""
"""The rest of a mapping, whose code is Python."""
_DEPLOY = """aos: 1
robot: cell
bundles: [{bundles}]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission: {{step_limit: 100000}}
solver: {{simulations: 20}}
bind: {{/step: {{python: "robot.py:act"}}, /reach: {{python: "robot.py:act"}}}}
runs: runs
"""
_ROBOT = "def act(call):\n    return {}\n"
_GOOD = "value = 1"


class Attempt(NamedTuple):
    """A case, played in one of the ways. `faults` are the promises that did not hold."""

    kind: str
    name: str
    way: str
    told_s: float | None
    faults: tuple[str, ...]


class Heard:
    """A process and what it has said. A thread reads all the time, so that it never waits for a reader."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self._process = process
        self._said = b""
        self._news = threading.Condition()
        self._has_ended = False
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def listen(self, words: str, timeout_s: float) -> float | None:
        """Returns when it has said the words; None if it ends, or the time does, before."""
        with self._news:
            self._news.wait_for(lambda: self._has_ended or words.encode() in self._said, timeout_s)
            return time.monotonic() if words.encode() in self._said else None

    def end(self) -> str:
        """Has it end by Ctrl-C if it has not, and returns all that it has said."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(timeout=_COMMAND_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._said += f"\n{_DID_NOT_END}".encode()
        self._reader.join(timeout=_COMMAND_S)
        return self._said.decode(errors="replace")

    def _read(self) -> None:
        assert self._process.stdout is not None
        while text := os.read(self._process.stdout.fileno(), 65536):
            with self._news:
                self._said += text
                self._news.notify_all()
        with self._news:
            self._has_ended = True
            self._news.notify_all()


class Playground:
    """A folder with a secret, a cache of compiled models and the documents of one attempt after the other."""

    def __init__(self, folder: Path, engines: Path) -> None:
        self.folder = folder
        self._bin = Path(sys.executable).parent
        self._secret = folder / "home" / "secret"
        self._canary = f"canary{secrets.token_hex(16)}"
        self._secret.parent.mkdir()
        self._secret.write_text(self._canary)
        self._secret.chmod(0o600)
        self._cache = folder / "cache"
        link_engines(engines, self._cache)
        self._environment = {
            **os.environ,
            "AOS_CACHE_DIR": str(self._cache),
            "AOS_RUNNING_DIR": str(folder / "running"),
            "AOS_CANARY": self._canary,
        }

    def play(self, kind: str, name: str, way: str) -> Attempt:
        """The attempt. Every process that it started must have ended with it."""
        code = {"model": MODELS, "compiler": COMPILED, "mapping": MAPPINGS}[kind][name]
        code = code.replace("SECRET", str(self._secret)).replace("FOLDER", str(self._secret.parent))
        place = self.folder / "documents"
        bundle = self._write(place, kind, code, apart=way == "push")
        started_s = time.monotonic()
        self._before_s = 0.0
        said, told_s = {"lint": self._lint, "push": self._push, "mission": self._mission}[way](
            place, bundle, _LINES[kind]
        )
        told_s = None if told_s is None else told_s - started_s - self._before_s
        return Attempt(kind, name, way, told_s, tuple(self._broken(kind, name, way, told_s, said)))

    def _write(self, place: Path, kind: str, code: str, *, apart: bool) -> Path:
        """Writes a deploy file, good documents, and the hostile ones: with the good ones, or `apart`."""
        subprocess.run(["rm", "-rf", str(place)], check=True)
        good = place / "good"
        hostile = place / "hostile" if apart else good
        good.mkdir(parents=True)
        hostile.mkdir(exist_ok=True)
        (place / "cell.yaml").write_text(_DEPLOY.format(bundles="good"))
        (place / "robot.py").write_text(_ROBOT)
        files = counting("cell", steps="100000")
        (good / "cell.ef").write_text(files["cell.ef"])
        (good / "step.sd").write_text(files["step.sd"])
        (good / "step.am").write_text(files["step.am"] + _RESULT.replace("CODE", _GOOD))
        model, mapping = ("", code) if kind == "mapping" else (code, _GOOD)
        files = counting("cell", "reach", code=model)
        (hostile / "reach.sd").write_text(files["reach.sd"])
        (hostile / "reach.am").write_text(files["reach.am"] + _RESULT.replace("CODE", mapping))
        if kind == "mapping" and not apart:
            # Then the mission has no other skill to choose.
            (good / "step.sd").unlink()
            (good / "step.am").unlink()
        return hostile

    def _lint(self, place: Path, bundle: Path, line: str) -> tuple[str, float | None]:
        words = [str(self._bin / "aos"), "lint", str(bundle)]
        return self._listened(words, place, line)

    def _mission(self, place: Path, bundle: Path, line: str) -> tuple[str, float | None]:
        words = [str(self._bin / "aos-up"), "cell.yaml", "--plain"]
        return self._listened(words, place, line)

    def _push(self, place: Path, bundle: Path, line: str) -> tuple[str, float | None]:
        """Pushes the hostile bundle into a mission that goes on; only the time from then on counts."""
        started_s = time.monotonic()
        mission = self._started([str(self._bin / "aos-up"), "cell.yaml", "--plain"], place)
        mission.listen("step", _COMMAND_S)
        self._before_s = time.monotonic() - started_s
        push = [
            str(self._bin / "aos"),
            "bundle",
            "push",
            str(bundle),
            "--run",
            str(place / "runs" / "latest"),
        ]
        said, told_s = self._listened(push, place, line)
        if told_s is None:
            told_s = mission.listen(line, _HEARD_S)
        return said + mission.end(), told_s

    def _listened(self, words: list[str], place: Path, line: str) -> tuple[str, float | None]:
        heard = self._started(words, place)
        told_s = heard.listen(line, _HEARD_S)
        return heard.end(), told_s

    def _started(self, words: list[str], place: Path) -> Heard:
        return Heard(
            subprocess.Popen(
                words, cwd=place, env=self._environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
            )
        )

    def _broken(self, kind: str, name: str, way: str, told_s: float | None, said: str) -> Iterator[str]:
        """The promises that do not hold."""
        if _DID_NOT_END in said:
            yield "the command did not end when it was told to"
        if self._canary in said:
            yield "the secret is in what was said"
        found = [path for path in self._written() if self._canary.encode() in path.read_bytes()]
        if found:
            yield f"the secret is in {found[0].relative_to(self.folder)}"
        if self._secret.read_text() != self._canary or self._secret.stat().st_mode & 0o777 != 0o600:
            yield "the secret is another"
        if list(self._secret.parent.iterdir()) != [self._secret]:
            yield "something was written"
        if left := _left_running():
            yield f"{len(left)} processes run on: {'; '.join(left)}"
        if told_s is None and name not in _HARMLESS and (kind, way) != ("mapping", "lint"):
            yield f"the line was not told: {said[-400:]!r}"

    def _written(self) -> Iterator[Path]:
        """Every file that the attempts have written, the engines apart, which were there before."""
        for path in self.folder.rglob("*"):
            if path != self._secret and path.is_file() and not path.is_symlink():
                yield path


def _left_running() -> list[str]:
    """The command lines of what has become a child of this process, which adopts what others leave behind."""
    while True:
        try:
            if os.waitpid(-1, os.WNOHANG)[0] == 0:
                break
        except ChildProcessError:
            return []
    listing = Path(f"/proc/self/task/{os.getpid()}/children").read_text()
    commands = (Path(f"/proc/{pid}/cmdline").read_bytes() for pid in listing.split())
    return [command.replace(b"\0", b" ").decode(errors="replace")[:200] for command in commands]


def attempts(ways: tuple[str, ...] = WAYS) -> Iterator[tuple[str, str, str]]:
    """Every case in every way, as `play` takes it. Linting runs no mappings, and is tried all the same."""
    for kind, cases in (("model", MODELS), ("compiler", COMPILED), ("mapping", MAPPINGS)):
        for name in cases:
            for way in ways:
                yield kind, name, way
