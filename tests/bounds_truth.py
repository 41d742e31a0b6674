"""Whether the point-based solver's bounds hold, on random models, against exact values by another program.

    python tests/bounds_truth.py [--models 10000] [--first-seed 1] [--work 10000000]

Each model is decided about three times, with so much work; ten million take some 0.1 s. A line of JSON for
every claim that does not hold, and one at the end: `mean_regret` and `worst_regret` say how much less than
the best the first decision's plan is sure to give, in parts of what is between acting by chance and the best,
where the exact value is known to a thousandth of that.
"""

from __future__ import annotations

import argparse
import asyncio
import subprocess
import sys
from pathlib import Path

from aos_deploy.program import cache_dir
from aos_solver.building.build import SOURCES
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import find_compiler

__all__ = ["truth_program"]

_FOLDER = Path(__file__).parent / "cpp" / "point_based"
_SOURCE = _FOLDER / "point_based_truth.cpp"
_SOLVER = SOURCES / "point_based.cpp"
_OPTIONS = ("-O2", f"-I{SOURCES}")
_EXECUTABLE = "truth"


def main() -> None:
    """Checks what the command line says; exit code 1 if any claim is false."""
    arguments = argparse.ArgumentParser(description="Checks bounds on random models.")
    arguments.add_argument("--models", type=int, default=10_000)
    arguments.add_argument("--first-seed", type=int, default=1)
    arguments.add_argument("--work", type=int, default=10_000_000)
    given = arguments.parse_args()
    program = truth_program(cache_dir())
    command = [program, str(given.first_seed), str(given.models), str(given.work)]
    sys.exit(subprocess.run(command, check=False).returncode)


def truth_program(cache: Path) -> Path:
    """The program that generates and checks, from the cache or compiled now."""
    return asyncio.run(_compiled(BuildCache(cache))) / _EXECUTABLE


async def _compiled(cache: BuildCache) -> Path:
    compiler = await find_compiler()
    sources = [*sorted(_FOLDER.iterdir()), _SOLVER, *sorted((SOURCES / "point_based").iterdir())]
    texts = [path.read_text() for path in sources]

    async def make(staging: Path) -> None:
        parts = [_SOURCE, _SOLVER]
        for part in parts:
            _run(compiler.compilation(str(part), f"{part.stem}.o", *_OPTIONS), staging)
        _run(compiler.linking([f"{part.stem}.o" for part in parts], _EXECUTABLE), staging)

    return await cache.fill(f"bounds-truth-{digest_of([compiler.version, *_OPTIONS, *texts])}", make)


def _run(command: list[str], staging: Path) -> None:
    subprocess.run(command, cwd=staging, check=True, timeout=240)


if __name__ == "__main__":
    main()
