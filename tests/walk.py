"""A newcomer's walk: docs/tutorial.md, done as it is written, in an empty folder.

    python -m tests.walk        with AOS installed from its wheel; some minutes, most of it for compilers

$AOS_CACHE_DIR names models that are compiled already, else there are none.
A comment before a block says what it is: `run`, `file: PATH`, `run in the background`, `run while it looks`,
`run when the mission has ended`.
"""

import os
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, Self

PAGE = Path(__file__).resolve().parents[1] / "docs" / "tutorial.md"
PATIENCE_S = 900.0
_BLOCK = re.compile(r"<!-- (.*?) -->\n```\w*\n(.*?)```", re.DOTALL)
_PORT = "bus: {listen: tcp/127.0.0.1:0}\n"
"""Other systems may run where this one does."""

_TAKES_ITS_TIME = "await asyncio.sleep(5)"
_WAITS = (
    f"while not pathlib.Path({{pushed!r}}).exists(): await asyncio.sleep(0.05)\n            {_TAKES_ITS_TIME}"
)
"""A look of the tutorial's robot begins to last when the bundle is pushed, however long that takes here: the
solver has as long to load the model as on the page."""


class Step(NamedTuple):
    """One block of the page: what its comment says, and its text."""

    kind: str
    text: str


def steps_of(page: Path = PAGE) -> list[Step]:
    return [Step(kind, text) for kind, text in _BLOCK.findall(page.read_text(encoding="utf-8"))]


class Walk:
    """Does the steps with the commands of a folder; `said` is what they printed."""

    def __init__(self, commands: Path, folder: Path, cache_dir: Path | None = None) -> None:
        self._folder = folder
        environment = {**os.environ, "PATH": f"{commands}{os.pathsep}{os.environ['PATH']}"}
        environment["AOS_RUNNING_DIR"] = str(folder / ".running")
        if cache_dir is not None:
            environment["AOS_CACHE_DIR"] = str(cache_dir)
        self._place: dict[str, Any] = {
            "cwd": folder,
            "env": environment,
            "stdin": subprocess.DEVNULL,
            "text": True,
        }
        self.said: dict[str, str] = {}
        self._background: subprocess.Popen[str] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._background is not None:
            self._background.kill()
            self._background.communicate()

    def do(self, step: Step) -> None:
        """Raises CalledProcessError or TimeoutExpired if a command does not do what the page says."""
        if step.kind.startswith("file: "):
            self._write(step.kind.removeprefix("file: "), step.text)
        elif step.kind == "run in the background":
            self._start(step.text.strip())
        elif step.kind == "run while it looks":
            self._until_line("step  1: look  [")
            self._run_all(step.text)
            (self._folder / "pushed").touch()
        elif step.kind == "run when the mission has ended":
            self._until_line("`aos mission start` begins the next")
            self._run_all(step.text)
            self._finish()
        else:
            self._run_all(step.text)

    def _run_all(self, text: str) -> None:
        for line in text.strip().splitlines():
            self._run(line)

    def _write(self, name: str, text: str) -> None:
        if name.endswith(".yaml"):
            text += _PORT
        if _TAKES_ITS_TIME in text:
            waits = _WAITS.format(pushed=str(self._folder / "pushed"))
            text = text.replace(_TAKES_ITS_TIME, waits).replace(
                "import random", "import pathlib\nimport random"
            )
        (self._folder / name).write_text(text, encoding="utf-8")

    def _run(self, line: str) -> None:
        done = subprocess.run(line.split(), **self._place, capture_output=True, timeout=PATIENCE_S)
        self.said[line] = done.stdout + done.stderr
        if done.returncode != 0:
            raise AssertionError(f"{line} ended with {done.returncode}:\n{self.said[line]}")

    def _start(self, line: str) -> None:
        out, errors = subprocess.PIPE, subprocess.STDOUT
        self._background = subprocess.Popen(line.split(), **self._place, stdout=out, stderr=errors)
        self.said[line] = ""

    def _until_line(self, part: str) -> None:
        for line in self._lines():
            if part in line:
                return
        raise AssertionError(f"it ended before any {part!r}:\n{self._last_said}")

    def _finish(self) -> None:
        """Ctrl-C in the first terminal."""
        assert self._background is not None
        self._background.send_signal(signal.SIGINT)
        for _ in self._lines():
            pass
        self._background.communicate(timeout=PATIENCE_S)
        if (status := self._background.returncode) != 0:
            raise AssertionError(f"the system ended with {status}:\n{self._last_said}")
        self._background = None

    def _lines(self) -> Iterator[str]:
        assert self._background is not None
        assert self._background.stdout is not None
        last = next(reversed([line for line in self.said if line.startswith("aos-up")]))
        for line in self._background.stdout:
            self.said[last] += line
            yield line

    @property
    def _last_said(self) -> str:
        return next(reversed(self.said.values()))


def main() -> int:
    from tests.installed import built_wheel, install

    root = PAGE.parents[1]
    with tempfile.TemporaryDirectory(prefix="aos-walk-") as scratch:
        place = Path(scratch)
        (place / "empty").mkdir()
        (place / "wheel").mkdir()
        print("walk: building and installing the wheel", flush=True)
        install(built_wheel(root, place / "wheel"), place / "environment", without=("pybullet", "PIL"))
        cache = None if "AOS_CACHE_DIR" in os.environ else place / "cache"
        with Walk(place / "environment" / "bin", place / "empty", cache) as walk:
            for step in steps_of():
                first = "" if step.kind.startswith("file") else f": {step.text.splitlines()[0]}"
                print(f"walk: {step.kind}{first}", flush=True)
                walk.do(step)
    print("walk: green")
    return 0


if __name__ == "__main__":
    sys.exit(main())
