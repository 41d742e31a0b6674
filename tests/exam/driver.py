"""The driver in C++: compiled once for all problems, and asked for one report after the other."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from aos_solver.building.build import SOURCES
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler

from .problem import Problem

__all__ = ["Driver", "built_driver"]

_CPP = Path(__file__).parent / "cpp"


async def built_driver(cache_dir: Path) -> Path:
    """The executable, from the cache or compiled now, which takes about a minute."""
    compiler = await find_compiler()
    sources = [*sorted(_CPP.glob("*")), *sorted(SOURCES.rglob("*.[ch]pp"))]
    name = f"exam-{digest_of([compiler.version, *(path.read_text() for path in sources)])}"

    async def make(staging: Path) -> None:
        exam = compiler.compilation(str(_CPP / "exam.cpp"), "exam.o", str(_CPP), f"-I{SOURCES}")
        numbers = compiler.compilation(str(SOURCES / "point_based.cpp"), "point_based.o", str(SOURCES), "-O3")
        await asyncio.gather(*(asyncio.to_thread(_run, command, staging) for command in (exam, numbers)))
        _run(_linking(compiler), staging)

    return await BuildCache(cache_dir).fill(name, make) / "exam"


def _linking(compiler: Compiler) -> list[str]:
    return compiler.linking(["exam.o", "point_based.o"], "exam")


def _run(command: list[str], staging: Path) -> None:
    done = subprocess.run(command, cwd=staging, capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        raise SystemExit(f"exam: the driver does not compile:\n{done.stderr}")


class Driver:
    """A process that reports on problems; one that dies or hangs is started again."""

    def __init__(self, executable: Path, what: str, options: Mapping[str, object], patience_s: float) -> None:
        self._command = [str(executable), what, *(str(word) for item in options.items() for word in item)]
        self._patience_s = patience_s
        self._process: subprocess.Popen[str] | None = None

    def report(self, problem: Problem) -> dict[str, Any]:
        """What it says about a problem; a `crash` where it did not survive it."""
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

    def close(self) -> None:
        """Ends the process."""
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
