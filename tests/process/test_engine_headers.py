"""The engine's headers by themselves: each sentence of tests/cpp/units is a test."""

from __future__ import annotations

import asyncio
import json
import re
import subprocess
from pathlib import Path

import pytest
from processes import HANG_S

from aos_solver.building.build import SOURCES
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler

TESTS = Path(__file__).parents[1]
UNITS = TESTS / "cpp" / "units"
TABLES = TESTS / "exam" / "cpp"
SENTENCES = re.compile(r'^TEST\("(.+)"\)', re.MULTILINE)

sentences = [
    sentence for path in sorted(UNITS.glob("*.cpp")) for sentence in SENTENCES.findall(path.read_text())
]


@pytest.fixture(scope="module")
def results(cache_dir: Path) -> dict[str, list[str]]:
    """What each test expected in vain."""
    executable = asyncio.run(built(BuildCache(cache_dir)))
    done = subprocess.run([executable], capture_output=True, text=True, timeout=HANG_S)
    told = [json.loads(line) for line in done.stdout.splitlines()]
    return {entry["test"]: entry["failures"] for entry in told}


@pytest.mark.parametrize("sentence", sentences)
def test_in_cpp(sentence: str, results: dict[str, list[str]]) -> None:
    assert sentence in results, "the tests ended before this one"
    assert not results[sentence], "\n".join(results[sentence])


async def built(cache: BuildCache) -> Path:
    compiler = await find_compiler()
    texts = [path for folder in (UNITS, TABLES, SOURCES) for path in sorted(folder.rglob("*.[ch]pp"))]
    name = f"units-{digest_of([compiler.version, *(path.read_text() for path in texts)])}"

    async def make(staging: Path) -> None:
        parts = [*sorted(UNITS.glob("*.cpp")), SOURCES / "point_based.cpp"]
        objects = [f"{part.parent.name}-{part.stem}.o" for part in parts]
        compilations = [command(compiler, part, name) for part, name in zip(parts, objects, strict=True)]
        await asyncio.gather(*(asyncio.to_thread(run, compilation, staging) for compilation in compilations))
        run(compiler.linking(objects, "units"), staging)

    return await cache.fill(name, make) / "units"


def command(compiler: Compiler, source: Path, output: str) -> list[str]:
    return compiler.compilation(str(source), output, str(SOURCES), "-O1", f"-I{TABLES}")


def run(command: list[str], staging: Path) -> None:
    done = subprocess.run(command, cwd=staging, capture_output=True, text=True, timeout=HANG_S)
    assert done.returncode == 0, done.stderr
