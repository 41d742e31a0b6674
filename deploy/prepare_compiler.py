"""Makes the C++ compiler ready for the first model: tries it, then compiles the engine into the cache.

Prints the compiler's version. Exit code 1 if there is no compiler, 2 if it cannot build. The first build with
the `ziglang` wheel also makes its C++ library, which takes a minute or two.
"""

import asyncio
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from aos_deploy.places import cache_dir
from aos_protocol.errors import AosError
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.engine_build import ANY_SIZE, build_engine

PROGRAM = "#include <vector>\nint main() { return std::vector<int>(3).size() == 3 ? 0 : 1; }\n"
LIMIT_S = 900
MEMORY_OF_TWO_BYTES = 4 << 30
"""The compiler takes 1.2 GB for an engine."""


def main() -> int:
    try:
        compiler = asyncio.run(find_compiler())
    except AosError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    if complaint := _complaint_about(compiler):
        sys.stderr.write(f"{compiler.version} cannot build a program:\n{complaint}")
        return 2
    sys.stdout.write(f"{compiler.version}\n")
    try:
        asyncio.run(build_engines(compiler))
    except (AosError, OSError) as error:
        sys.stderr.write(f"{compiler.version} cannot build the engine:\n{error}\n")
        return 2
    return 0


async def build_engines(compiler: Compiler) -> None:
    """The engine of most models and the one that takes all others, side by side where there is memory."""
    usual = build_engine(cache_dir(), compiler=compiler)
    other = build_engine(cache_dir(), compiler=compiler, state_bytes=ANY_SIZE)
    if os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") >= MEMORY_OF_TWO_BYTES:
        await asyncio.gather(usual, other)
    else:
        await usual
        await other


def _complaint_about(compiler: Compiler) -> str:
    """Returns the compiler's complaint about a small program, built the way models are; empty if it runs."""
    with tempfile.TemporaryDirectory() as folder:
        source, thing, program = (str(Path(folder) / name) for name in ("try.cpp", "try.o", "try"))
        Path(source).write_text(PROGRAM)
        for command in (
            compiler.compilation(source, thing, folder),
            compiler.linking([thing], program),
            [program],
        ):
            done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
            if done.returncode != 0:
                return f"{done.stderr}{done.stdout}" or f"exit status {done.returncode}\n"
    return ""


if __name__ == "__main__":
    sys.exit(main())
