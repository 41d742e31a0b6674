"""The hand-written baselines of tests/bench: compiled once for this machine, and run."""

import asyncio
import re
from pathlib import Path
from typing import Self

import msgspec

from aos_deploy.places import shipped
from aos_protocol.errors import ModelError
from aos_runtime.processes.children import PIPE, Child
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler
from aos_solver.building.engine_build import SOURCES

NAME = "by hand"
SOURCE = shipped("tests/bench/baseline.cpp")
WITHOUT_KNOWLEDGE = "simulations, uniform"
PROBLEMS = ("tiger", "rocksample-7-8", "navigation")

# For this processor and no other: the bound is what the machine can do.
_FLAGS = ("-std=c++20", "-O3", "-march=native")
_PROGRAM = "baseline"
_COMPILATION_S = 120.0
_RUN_MARGIN_S = 60.0


class BaselineFigure(msgspec.Struct, frozen=True):
    """A rate per second of processor time. `check` is a step's mean reward, or a simulation's steps."""

    problem: str
    metric: str
    value: float
    check: float


class Baselines:
    """The compiled program."""

    def __init__(self, program: Path) -> None:
        self._program = program

    @classmethod
    async def built(cls, compiler: Compiler, cache_dir: Path) -> Self:
        """The program from the cache, or compiled now; ModelError AOS201 if it does not compile."""
        paths = [*sorted(SOURCE.parent.iterdir()), SOURCES / "aos" / "base" / "xoshiro.hpp"]
        texts = [path.read_text() for path in paths if path.is_file()]
        name = f"baseline-{digest_of([compiler.version, *_FLAGS, _processor(), *texts])}"

        async def make(staging: Path) -> None:
            command = [*compiler.command, *_FLAGS, f"-I{SOURCES}", str(SOURCE), "-o", str(staging / _PROGRAM)]
            status, _, messages = await _output(command, _COMPILATION_S)
            if status != 0:
                said = messages.decode(errors="replace")
                raise ModelError(f"{SOURCE} does not compile: {said}")

        return cls(await BuildCache(cache_dir).fill(name, make) / _PROGRAM)

    async def measure(self, problem: str, seconds: float, seed: int) -> list[BaselineFigure]:
        """All figures of one of PROBLEMS, each measured for so long."""
        command = [str(self._program), problem, str(seconds), str(seed)]
        status, lines, messages = await _output(command, 10 * seconds + _RUN_MARGIN_S)
        if status != 0:
            raise ModelError(f"the baseline failed: {messages.decode(errors='replace')}", code="AOS213")
        return [msgspec.json.decode(line, type=BaselineFigure) for line in lines.splitlines()]


def _processor() -> str:
    """The processor with what it can do, as Linux tells; empty where it does not."""
    try:
        told = Path("/proc/cpuinfo").read_text()
    except OSError:
        return ""
    first = told.partition("\n\n")[0]
    return "\n".join(re.findall(r"^(?:model name|flags|Features)\s*:.*$", first, re.MULTILINE))


async def _output(command: list[str], deadline_s: float) -> tuple[int, bytes, bytes]:
    """Exit status, standard output and standard error of a command."""
    child = await Child.start(command, stdout=PIPE, stderr=PIPE)
    try:
        async with asyncio.timeout(deadline_s):
            said, complained = await asyncio.gather(child.stdout.read(), child.stderr.read())
            return await child.wait(), said, complained
    except TimeoutError:
        raise ModelError(f"{command[0]} did not finish within {deadline_s:.0f} s", code="AOS211") from None
    finally:
        await child.stop()
