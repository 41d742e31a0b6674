"""Tests of the headers and the driver of the exam in one program: both stand on the same templates."""

from __future__ import annotations

import asyncio
from pathlib import Path

from exam.programs import built_program

__all__ = ["UNITS", "engine_checks"]

UNITS = Path(__file__).parent / "cpp" / "units"
_TABLES = Path(__file__).parent / "exam" / "cpp"


def engine_checks(cache_dir: Path) -> Path:
    """The program, from the cache or compiled now. The command of the exam has one that is optimised more."""
    return asyncio.run(built_program(cache_dir, UNITS / "checks.cpp", "-O1", includes=[_TABLES]))
