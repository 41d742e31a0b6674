"""Emitted models without the engine: a test gives the draws and sees what every step does."""

import asyncio
import json
import re
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
from exam.programs import PATIENCE_S, run, what_decides
from processes import COMMAND_S

from aos_deploy.places import cache_dir
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Project
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import find_compiler
from aos_solver.building.engine_build import SOURCES, SUPPORT
from aos_solver.emission.emit import EmittedModel, emit
from aos_solver.emission.lowering.lower import lower

_DRIVER = Path(__file__).parent / "cpp" / "scripted"
_OPTIONS = ("-O0", "-DAOS_QUICK")
_EXECUTABLE = "scripted"
_TABLE = re.compile(r"constinit const aos::ModelTable .*\s+aos::table_of<(.*)>\(\);")
_SCRIPTED_TABLE = r"""#include "scripted.hpp"
constinit const aos::ScriptedModel aos::scripted_model = aos::scripted_model_of<\1>();"""


class Played(msgspec.Struct, frozen=True):
    """The initial state, and each step with what it gave. Leaves of states are text."""

    initial: Mapping[str, Any]
    steps: list[dict[str, Any]]

    @property
    def rewards(self) -> list[float]:
        return [step["reward"] for step in self.steps]

    @property
    def observations(self) -> list[str]:
        return [step["observation"] for step in self.steps]

    def values(self, name: str) -> list[str]:
        return [self.initial["state"][name], *(step["state"][name] for step in self.steps)]


class ScriptedModel(msgspec.Struct, frozen=True):
    emitted: EmittedModel
    executable: Path

    def play(self, *actions: str, initial: str = "") -> Played:
        answer = self._run("play", script="\n".join([initial, *actions]) + "\n")
        assert isinstance(answer, list), answer
        return Played(answer[0], answer[1:])

    def fault(self, *actions: str, initial: str = "") -> dict[str, Any]:
        answer = self._run("play", script="\n".join([initial, *actions]) + "\n")
        assert isinstance(answer, dict), answer
        return answer

    def describe(self) -> dict[str, Any]:
        return {action["action"]: action["parameters"] for action in self._run("describe")}

    def walk(self, steps: int) -> dict[str, Any]:
        """Takes that many steps of random actions, with a new start at each end."""
        answer: dict[str, Any] = self._run("walk", "1", str(steps))
        return answer

    def _run(self, *arguments: str, script: str = "") -> Any:
        done = subprocess.run(
            [self.executable, *arguments],
            input=script,
            capture_output=True,
            text=True,
            timeout=COMMAND_S,
            check=True,
        )
        return json.loads(done.stdout)


def json_text(document: Mapping[str, Any], kind: str, name: str, project: str = "test") -> str:
    header = {"Project": project, "Name": name, "Type": kind, "Version": 1}
    return json.dumps({"PlpMain": header, **document}, indent=2)


def lowered(project: Project) -> tuple[EmittedModel, tuple[Diagnostic, ...]]:
    program, diagnostics = lower(project)
    assert program is not None, diagnostics
    return emit(program), diagnostics


def scripted(project: Project) -> ScriptedModel:
    emitted, _ = lowered(project)
    return ScriptedModel(emitted, asyncio.run(_compiled(emitted)) / _EXECUTABLE)


async def _compiled(emitted: EmittedModel) -> Path:
    compiler = await find_compiler()
    cache = BuildCache(cache_dir())
    decides = [*_OPTIONS, *what_decides(compiler, _DRIVER)]

    async def make_driver(staging: Path) -> None:
        run(compiler.compilation(str(_DRIVER / "scripted.cpp"), "driver.o", str(SOURCES), *_OPTIONS), staging)
        (staging / SUPPORT).parent.mkdir(parents=True)
        run(compiler.precompilation(SUPPORT, str(SOURCES), ".", *_OPTIONS), staging)

    async def make(staging: Path) -> None:
        (staging / "scripted.cpp").write_text(_TABLE.sub(_SCRIPTED_TABLE, emitted.cpp))
        options = [*_OPTIONS, *compiler.precompiled(SUPPORT, str(driver)), f"-I{_DRIVER}"]
        run(compiler.compilation("scripted.cpp", "scripted.o", str(SOURCES), *options), staging)
        run(compiler.linking(["scripted.o", str(driver / "driver.o")], _EXECUTABLE), staging)

    driver = await cache.fill(f"driver-{digest_of(decides)}", make_driver, patience_s=PATIENCE_S)
    return await cache.fill(f"scripted-{digest_of([emitted.cpp, *decides])}", make, patience_s=PATIENCE_S)
