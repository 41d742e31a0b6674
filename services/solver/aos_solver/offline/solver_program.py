"""The solver's executable: compiled once, from the sources beside this file."""

from __future__ import annotations

import asyncio
from pathlib import Path

from aos_protocol.errors import ModelError
from aos_runtime.children import PIPE, Child, Limits, guarded
from aos_solver.build import SOURCES
from aos_solver.build_cache import BuildCache, digest_of
from aos_solver.compiler import Compiler, find_compiler

__all__ = ["build_solver"]

_FOLDER = Path(__file__).parent / "cpp"
_JSON = SOURCES / "aos" / "json.hpp"
_OBJECT = "sarsop.o"
_EXECUTABLE = "sarsop"


async def build_solver(cache_dir: Path, compiler: Compiler | None = None) -> Path:
    """The executable, from the cache or compiled now; ModelError AOS203 without a compiler."""
    compiler = compiler or await find_compiler()
    compilation = compiler.compilation(str(_FOLDER / "sarsop.cpp"), _OBJECT, str(SOURCES), "-O3")
    texts = [path.read_text() for path in (*sorted(_FOLDER.iterdir()), _JSON)]
    options = compiler.compilation("", "", "", "-O3")
    name = f"sarsop-{digest_of([compiler.version, *options, *texts])}"

    async def make(staging: Path) -> None:
        await _run(compilation, staging, compiler.deadline_s)
        await _run(compiler.linking([_OBJECT], _EXECUTABLE), staging, compiler.deadline_s)

    return await BuildCache(cache_dir).fill(name, make) / _EXECUTABLE


async def _run(command: list[str], directory: Path, deadline_s: float) -> None:
    child = await Child.start(
        guarded(command, Limits()),
        cwd=directory,
        env={"LC_ALL": "C"},
        stdout=PIPE,
        stderr=asyncio.subprocess.STDOUT,
    )
    try:
        async with asyncio.timeout(deadline_s):
            output = (await child.stdout.read()).decode(errors="replace")
            status = await child.wait()
    except TimeoutError:
        message = f"the compiler did not finish the solver within {deadline_s:g} s"
        raise ModelError(message, code="AOS202") from None
    finally:
        await child.stop()
    if status != 0:
        reason = next(iter(output.strip().splitlines()), f"status {status}")
        hint = "This is not a mistake in the documents; please report it"
        raise ModelError(f"the C++ of the solver does not compile: {reason}", hint=hint)
