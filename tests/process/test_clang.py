"""Clang compiles models and what of the engine stands beside them: who has no g++ gets it from a wheel.

All other tests compile with the first compiler that the machine has, which is g++ nearly everywhere.
"""

import asyncio
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import msgspec
import pytest
from exam.programs import run, what_decides
from places import BUNDLES
from projects import bundle_project
from scripted_models import lowered

from aos_deploy.deployment.mission_values import constrained, constraint_of_option
from aos_protocol.documents import Project
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.engine_build import ENGINE, FUNCTIONS, NUMBERS, SOURCES
from aos_solver.emission.emit import MODEL_FILE

UNOPTIMIZED = ("-O0", "-DAOS_QUICK")
STATE = "-DAOS_STATE_BYTES=64"


@pytest.fixture
def clang(cache_dir: Path, monkeypatch) -> Compiler:
    """The Clang of the wheel that set-up installs for development, or else that of the machine."""
    if asyncio.run(find_compiler()).family != "gcc":
        pytest.skip("all tests compile with Clang here")
    name = f"{sys.executable} -m ziglang c++" if find_spec("ziglang") else which("clang++")
    if name is None:
        pytest.skip("needs Clang: pip install --require-hashes -r deploy/lock/compiler.txt")
    for place in ("GLOBAL", "LOCAL"):
        monkeypatch.setenv(f"ZIG_{place}_CACHE_DIR", str(cache_dir / "zig"))
    return asyncio.run(find_compiler({"CXX": name}))


@pytest.mark.parametrize("bundle", ["armadillo-finer", "tictactoe", "bench/lightdark-normal"])
def test_clang_compiles_a_model(bundle, clang: Compiler, cache_dir: Path):
    compile_model(bundle_project(BUNDLES / bundle), clang, cache_dir)


def test_clang_compiles_a_model_with_a_costly_constraint(clang: Compiler, cache_dir: Path):
    never = constraint_of_option("0.01: serve && state.arm_outstretched")
    project = constrained(bundle_project(BUNDLES / "armadillo-finer"), [never])
    costly = msgspec.structs.replace(project.constraints[0], cost=100.0)
    compile_model(msgspec.structs.replace(project, constraints=(costly,)), clang, cache_dir)


@pytest.mark.parametrize("part", [ENGINE, NUMBERS, FUNCTIONS])
def test_clang_compiles_what_all_models_share(part, clang: Compiler, cache_dir: Path):
    command = clang.compilation(str(SOURCES / f"{part}.cpp"), "part.o", str(SOURCES), "-O0", STATE)
    once([part], clang, cache_dir, lambda folder: run(command, folder))


def compile_model(project: Project, compiler: Compiler, cache_dir: Path):
    emitted, _ = lowered(project)

    def make(folder: Path):
        (folder / MODEL_FILE).write_text(emitted.cpp)
        run(compiler.compilation(MODEL_FILE, "model.o", str(SOURCES), *UNOPTIMIZED), folder)

    once([emitted.cpp], compiler, cache_dir, make)


def once(parts: list[str], compiler: Compiler, cache_dir: Path, make: Callable[[Path], None]):

    async def in_folder(folder: Path):
        make(folder)

    name = f"clang-{digest_of([*parts, *what_decides(compiler)])}"
    asyncio.run(BuildCache(cache_dir).fill(name, in_folder))
