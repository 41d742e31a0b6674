"""The headers of beliefs alone, with models written in C++: see tests/cpp/belief_checks.cpp."""

from __future__ import annotations

import asyncio
import subprocess
from pathlib import Path

from processes import HANG_S

from aos_solver.building.build import SOURCES
from aos_solver.building.compiler import find_compiler

CHECKS = Path(__file__).parent.parent / "cpp" / "belief_checks.cpp"


def test_beliefs_are_what_probability_theory_says(tmp_path: Path) -> None:
    compiler = asyncio.run(find_compiler())
    checks = tmp_path / "checks"
    command = [*compiler.command, "-std=c++20", "-O1", f"-I{SOURCES}", str(CHECKS), "-o", str(checks)]
    subprocess.run(command, check=True, timeout=HANG_S)
    done = subprocess.run([checks], capture_output=True, text=True, timeout=HANG_S)
    assert (done.returncode, done.stdout) == (0, "")
