"""The hand-written baselines of tests/bench: compiled with this machine's compiler, and run."""

from __future__ import annotations

import asyncio
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from aos_deploy.shipped import shipped
from aos_protocol.errors import ModelError
from aos_runtime.children import PIPE, Child
from aos_solver.building.compiler import Compiler

__all__ = ["NAME", "PROBLEMS", "WITHOUT_KNOWLEDGE", "BaselineFigure", "Baselines"]

NAME = "by hand"
SOURCE = shipped("tests/bench/baseline.cpp")
WITHOUT_KNOWLEDGE = "simulations, uniform"
PROBLEMS = ("tiger", "rocksample-7-8", "navigation")

_COMPILATION_S = 120.0
_RUN_MARGIN_S = 60.0


class BaselineFigure(msgspec.Struct, frozen=True):
    """A rate per second of processor time. `check` is a step's mean reward, or a simulation's steps."""

    problem: str
    metric: str
    value: float
    check: float


class Baselines:
    """The compiled program, in a folder that goes with it. Usable with `async with`."""

    def __init__(self, compiler: Compiler) -> None:
        self._compiler = compiler
        self._folder = TemporaryDirectory(prefix="aos-bench-")

    async def __aenter__(self) -> Baselines:
        # For this processor and no other: the bound is what the machine can do.
        flags = ["-std=c++20", "-O3", "-march=native"]
        command = [*self._compiler.command, *flags, str(SOURCE), "-o", str(self._program)]
        status, _, messages = await _output(command, _COMPILATION_S)
        if status != 0:
            raise ModelError(f"{SOURCE} does not compile: {messages.decode(errors='replace')}", code="AOS201")
        return self

    async def __aexit__(self, *_: object) -> None:
        self._folder.cleanup()

    async def measure(self, problem: str, seconds: float, seed: int) -> list[BaselineFigure]:
        """All figures of one of PROBLEMS, each measured for so long."""
        command = [str(self._program), problem, str(seconds), str(seed)]
        status, lines, messages = await _output(command, 10 * seconds + _RUN_MARGIN_S)
        if status != 0:
            raise ModelError(f"the baseline failed: {messages.decode(errors='replace')}", code="AOS213")
        return [msgspec.json.decode(line, type=BaselineFigure) for line in lines.splitlines()]

    @property
    def _program(self) -> Path:
        return Path(self._folder.name) / "baseline"


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
