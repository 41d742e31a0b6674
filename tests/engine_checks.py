"""Tests of the headers and the driver of the exam in one program: both stand on the same templates.

python tests/engine_checks.py    compiles it into the cache of the tests: the better part of a minute
"""

import asyncio
from pathlib import Path

from exam.programs import built_program
from kept_cache import kept_cache

UNITS = Path(__file__).parent / "cpp" / "units"
_TABLES = Path(__file__).parent / "exam" / "cpp"


def engine_checks(cache_dir: Path) -> Path:
    """The program, from the cache or compiled now. The command of the exam has one that is optimised more."""
    checked = ("-O1", "-DAOS_CHECKED")
    return asyncio.run(built_program(cache_dir, UNITS / "checks.cpp", *checked, includes=[_TABLES]))


if __name__ == "__main__":
    engine_checks(kept_cache())
