"""The driver in C++: compiled once for all problems, and asked for one report after the other."""

import json
import os
import subprocess
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .problem import Problem
from .programs import built_program

_CPP = Path(__file__).parent / "cpp"


async def built_driver(cache_dir: Path) -> Path:
    """The executable, from the cache or compiled now, which takes half a minute."""
    return await built_program(cache_dir, _CPP / "exam.cpp")


class Driver:
    """A process that reports on problems; one that dies or hangs is started again."""

    def __init__(self, executable: Path, what: str, options: Mapping[str, object], patience_s: float):
        self._command = [str(executable), what, *(str(word) for item in options.items() for word in item)]
        self._patience_s = patience_s
        self._process: subprocess.Popen[str] | None = None

    def report(self, problem: Problem) -> dict[str, Any]:
        """Returns the driver's report on a problem; a `crash` where it did not survive it."""
        process = self._process = self._process or self._start()
        assert process.stdin is not None
        assert process.stdout is not None
        timer = threading.Timer(self._patience_s, process.kill)
        timer.start()
        try:
            process.stdin.write(problem.text())
            process.stdin.flush()
            line = process.stdout.readline()
        except BrokenPipeError:
            line = ""
        finally:
            is_late = not timer.is_alive()
            timer.cancel()
        if line:
            report: dict[str, Any] = json.loads(line)
            return report
        process.communicate()
        status = process.returncode
        self._process = None
        ending = f"no report within {self._patience_s:.0f} s" if is_late else f"ended with status {status}"
        return {"problem": problem.name, "crash": ending}

    def close(self):
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _start(self) -> subprocess.Popen[str]:
        return subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "MALLOC_ARENA_MAX": "1"},
        )
