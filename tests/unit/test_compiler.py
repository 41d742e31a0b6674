import os
from pathlib import Path

import pytest

from aos_protocol.errors import ModelError
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.compiler_run import run_compiler


def fake(directory: Path, name: str, text: str, status: int = 0):
    path = directory / name
    path.write_text(f"#!/bin/sh\necho '{text}'\nexit {status}\n")
    path.chmod(0o755)


@pytest.fixture
def no_wheel(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)


@pytest.fixture
def tools(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    return tmp_path


async def test_cxx_comes_first(tools: Path):
    fake(tools, "g++", "g++ (Debian 12.2.0-14) 12.2.0")
    fake(tools, "mine", "clang version 17.0.6")
    found = await find_compiler({"CXX": f"{tools}/mine --gcc-toolchain=/x", "PATH": str(tools)})
    assert found.command == (f"{tools}/mine", "--gcc-toolchain=/x")
    assert found.family == "clang"


async def test_a_compiler_that_is_too_old_or_broken_is_passed_over(tools: Path, no_wheel: None):
    fake(tools, "g++", "g++ (Ubuntu 9.4.0-1) 9.4.0")
    fake(tools, "clang++", "Debian clang version 16.0.6 (15~deb12u1)")
    assert (await find_compiler({"PATH": str(tools)})).command == ("clang++",)


async def test_without_a_compiler_the_error_says_what_to_install(tools: Path, no_wheel: None):
    fake(tools, "g++", "", status=1)
    with pytest.raises(ModelError) as raised:
        await find_compiler({"PATH": str(tools)})
    assert raised.value.code == "AOS203"
    assert "g++ does not run" in raised.value.message
    assert "apt install g++" in raised.value.hint


async def test_a_cxx_that_does_not_work_is_not_passed_over(tools: Path):
    fake(tools, "g++", "g++ (Debian 12.2.0-14) 12.2.0")
    with pytest.raises(ModelError, match="CXX is set, but"):
        await find_compiler({"CXX": "/nowhere/c++", "PATH": str(tools)})


async def test_the_wheel_is_the_last_resort(tools: Path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: object())
    fake(tools, "python", "clang version 19.1.7")
    monkeypatch.setattr("sys.executable", str(tools / "python"))
    found = await find_compiler({"PATH": str(tools)})
    assert found.command[1:] == ("-m", "ziglang", "c++")
    assert found.family == "zig"
    assert found.deadline_s > 200


async def test_this_machine_has_one(cache_dir: Path):
    found = await find_compiler(os.environ)
    assert "-std=c++20" in found.compilation("a.cpp", "a.o", str(cache_dir))


async def test_a_compiler_that_talks_without_end_is_read_to_its_end_and_not_kept(tmp_path):
    talking = ["sh", "-c", "head -c 5000000 /dev/zero | tr '\\0' x; exit 3"]
    said, status = await run_compiler(Compiler(("sh",), "gcc", ""), talking, tmp_path, 30.0, "a model")
    assert (len(said), status) == (4 << 20, 3)
