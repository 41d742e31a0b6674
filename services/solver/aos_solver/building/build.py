"""The build of a model: from the emitted C++ to an executable, through a cache.

A model is compiled by itself and linked to the engine (`engine_build.py`).

A model has two builds, which decide alike. The quick build is there sooner. The thorough build makes faster
steps, and hardly faster searches: most of a search is the engine.
"""

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import msgspec

from aos_protocol.diagnostics import Diagnostic, Severity
from aos_protocol.errors import AosError, ModelError
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.compiler_messages import read_messages, without_line_directives
from aos_solver.building.compiler_run import LIMIT_HINT, internal_error, ran_out, run_compiler, together
from aos_solver.building.engine_build import (
    ANY_SIZE,
    QUICK,
    SOURCES,
    STATE_BYTES,
    SUPPORT,
    build_engine,
    circumstances,
    engine_deadline_s,
    engine_name,
    engine_seconds,
    objects_of,
)
from aos_solver.emission.emit import MODEL_FILE, EmittedModel

MAX_STATE_BYTES = 1 << 20

BuildKind = Literal["quick", "thorough", "unoptimized"]
"""The ways to compile a model; unoptimized code keeps its order."""

_OPTIONS: dict[BuildKind, tuple[str, ...]] = {
    "quick": QUICK,
    "thorough": (),
    "unoptimized": ("-O0", "-DAOS_QUICK"),
}

MODEL_CPU_S = 2.0
ENGINE_SHARE = 1 / 20
LINES_PER_CPU_S = 150
"""A quick build may take `MODEL_CPU_S` of processor time, or `ENGINE_SHARE` of the engine's where that is
more, and a second more for `LINES_PER_CPU_S` lines. Before an engine is compiled nobody knows how slow the
machine is, and what models include is not compiled ahead: then only the deadline counts. A model of 200 lines
takes half a second, of 700 lines up to 3 s, all parts of the engine 35 s."""

_LIMITS = ("-ftemplate-depth=100",)
"""Models' templates need a third of this depth. Document code that recurses without end is told at once."""

_COMPILE_TIME_CODE = re.compile(r"\b(?:template|constexpr|consteval|\w*(?:_constant|_sequence))\b|\]\s*<")

_SOURCE = "compiled.cpp"
_OBJECT = "part.o"
_UNCOUNTED = "AOS_UNCOUNTED"
"""Leaves out the code that counts the conditions of rewards and goals (`goal_conditions.py`)."""

_EXECUTABLE = "model"
_STATE_BYTES_MARK = re.compile(rb"aos-state-bytes:(\d+);")


class BuiltModel(msgspec.Struct, frozen=True):
    """An executable with the emitted text, which stands beside it as `model.cpp`.

    Engines are started with the `mission_values`, in their canonical spelling by the names of parameters'
    parts; the others have their defaults. The executable is the same for all values.
    """

    emitted: EmittedModel
    executable: Path
    mission_values: dict[str, str] = {}

    @property
    def digest(self) -> str:
        """The digest of all that decides about the executable."""
        return self.executable.parent.name.removeprefix("model-")

    @property
    def cache_dir(self) -> Path:
        return self.executable.parent.parent


async def build(
    emitted: EmittedModel,
    *,
    cache_dir: Path,
    compiler: Compiler | None = None,
    on_progress: Callable[[str], None] = lambda text: None,
    deadline_s: float | None = None,
    kind: BuildKind = "quick",
    niceness: int = 0,
) -> BuiltModel:
    """The executable of a model, from the cache or compiled now.

    A thorough build that is in the cache is taken for a quick one. With a `niceness` of up to 19 the compiler
    leaves the processor to other work.
    ModelError AOS201 carries the compiler's errors as diagnostics at the documents' places, or names the
    emitted file where an error is not in document code; AOS202 when the compiler ran out of time or memory;
    AOS203 without a compiler.
    """
    compiler = compiler or await find_compiler()
    cache = BuildCache(cache_dir)
    shared = circumstances(compiler)
    names = {
        known: f"model-{digest_of([emitted.cpp, *options, shared])}" for known, options in _OPTIONS.items()
    }
    for known in ("thorough", "quick") if kind == "quick" else (kind,):
        if (entry := cache.find(names[known])) is not None:
            return BuiltModel(emitted, entry / _EXECUTABLE)
    deadline_s = deadline_s or compiler.deadline_s
    work = _Build(emitted, cache, compiler, on_progress, deadline_s, kind, niceness)
    started_s = time.monotonic()
    made_here: list[Path] = []

    async def make(staging: Path) -> None:
        made_here.append(staging)
        await work.make(staging)

    entry = await cache.fill(
        names[kind], make, patience_s=_patience_s(compiler, deadline_s), on_wait=work.tell_wait
    )
    by_whom = "compiled" if made_here else "another process compiled"
    on_progress(f"{by_whom} {emitted.project} in {time.monotonic() - started_s:.1f} s")
    return BuiltModel(emitted, entry / _EXECUTABLE)


def _patience_s(compiler: Compiler, deadline_s: float) -> float:
    """Returns how long another process is waited for that makes the same model: as long as it may take."""
    return 2 * (engine_deadline_s(compiler) + deadline_s)


class _Build(msgspec.Struct, frozen=True):
    """One model on its way into the cache."""

    emitted: EmittedModel
    cache: BuildCache
    compiler: Compiler
    on_progress: Callable[[str], None]
    deadline_s: float
    kind: BuildKind
    niceness: int

    async def make(self, staging: Path) -> None:
        self.on_progress(f"compiling {self.emitted.project} with {self.compiler.version}")
        usual, _ = await together(self._engine(STATE_BYTES[0]), self._compile(staging))
        state_bytes = self._state_bytes(staging / _OBJECT)
        engine = usual if state_bytes == STATE_BYTES[0] else await self._engine(self._ready_size(state_bytes))
        await self._link(staging, objects_of(usual, engine))

    def tell_wait(self) -> None:
        """Tells that another process makes the model, and whether it makes the engine first."""
        is_long = self._ready_engine(STATE_BYTES[0]) is None
        engine = ", with the engine: once for all models, which takes some minutes" if is_long else ""
        self.on_progress(f"waiting for {self.emitted.project}, which another process compiles{engine}")

    def _ready_engine(self, state_bytes: int) -> Path | None:
        return self.cache.find(engine_name(self.compiler, state_bytes))

    async def _engine(self, state_bytes: int) -> Path:
        return await build_engine(
            self.cache.directory,
            compiler=self.compiler,
            on_progress=self.on_progress,
            state_bytes=state_bytes,
        )

    @property
    def _cpu_s(self) -> int | None:
        """The limit for a model that somebody waits for. Long models and slow machines have more."""
        engine_s = engine_seconds(self._ready_engine(STATE_BYTES[0]))
        if self.kind != "quick" or not engine_s:
            return None
        return int(max(MODEL_CPU_S, ENGINE_SHARE * engine_s) + self.emitted.cpp.count("\n") / LINES_PER_CPU_S)

    async def _compile(self, staging: Path) -> None:
        (staging / MODEL_FILE).write_text(self.emitted.cpp)
        (staging / _SOURCE).write_text(without_line_directives(self.emitted.cpp))
        output, status = await self._compiled(staging)
        if status != 0 and _UNCOUNTED in self.emitted.cpp:
            # Counting code is made of the documents' text, and errors are told of that text alone.
            output, status = await self._compiled(staging, f"-D{_UNCOUNTED}")
        if status != 0:
            raise self._failure(output, status)
        (staging / _SOURCE).unlink()

    async def _compiled(self, staging: Path, *more: str) -> tuple[str, int]:
        options = [*_OPTIONS[self.kind], *self._precompiled, *_LIMITS, *more]
        compilation = self.compiler.compilation(_SOURCE, _OBJECT, str(SOURCES), *options)
        return await self._run(compilation, staging, [SOURCES, *self._ready_entry], cpu_s=self._cpu_s)

    @property
    def _precompiled(self) -> list[str]:
        """The options for what quick builds include, if that is compiled already."""
        if self.kind != "quick":
            return []
        return [
            option for entry in self._ready_entry for option in self.compiler.precompiled(SUPPORT, str(entry))
        ]

    @property
    def _ready_entry(self) -> list[Path]:
        entry = self._ready_engine(STATE_BYTES[0])
        return [] if entry is None else [entry]

    def _state_bytes(self, model: Path) -> int:
        """The size of the quickest engine that takes the model's states."""
        mark = _STATE_BYTES_MARK.search(model.read_bytes())
        needed = int(mark[1]) if mark is not None else 0
        if needed > MAX_STATE_BYTES:
            message = (
                f"a state of {self.emitted.project} takes {needed} bytes; {MAX_STATE_BYTES} is the limit"
            )
            raise ModelError(message, hint="Use smaller vectors and maps for state variables")
        return next((state_bytes for state_bytes in STATE_BYTES if needed <= state_bytes), ANY_SIZE)

    def _ready_size(self, state_bytes: int) -> int:
        """`state_bytes`, or `ANY_SIZE` where a quick build would have to compile that engine first."""
        is_waiting = self.kind == "quick" and self._ready_engine(state_bytes) is None
        return ANY_SIZE if is_waiting and self._ready_engine(ANY_SIZE) is not None else state_bytes

    async def _link(self, staging: Path, engine: list[Path]) -> None:
        model = staging / _OBJECT
        linking = self.compiler.linking([str(part) for part in (model, *engine)], _EXECUTABLE)
        output, status = await self._run(linking, staging, engine)
        if status != 0:
            raise internal_error(self.emitted.project, output, status, self._kept_source())
        (staging / _EXECUTABLE).chmod(0o755)  # A linker that may not change modes leaves that to us.
        model.unlink()

    async def _run(
        self, command: list[str], staging: Path, reads: list[Path], *, cpu_s: int | None = None
    ) -> tuple[str, int]:
        return await run_compiler(
            self.compiler,
            command,
            staging,
            self.deadline_s,
            self.emitted.project,
            hint=LIMIT_HINT,
            niceness=self.niceness,
            cpu_s=cpu_s,
            reads=reads,
        )

    def _failure(self, output: str, status: int) -> AosError:
        project = self.emitted.project
        report = read_messages(output, _SOURCE, self.emitted)
        if report.diagnostics:
            message = f"the model code of {project} does not compile"
            return ModelError(message, hint="Mend the places named", diagnostics=report.diagnostics)
        if ran_out(output, status):
            return self._limit_error()
        return internal_error(project, "\n".join(report.outside) or output, status, self._kept_source())

    def _limit_error(self) -> ModelError:
        """The error at the first document code that may compute while it is compiled, if there is any."""
        message = f"the compiler ran out of time or memory on {self.emitted.project}"
        suspects = (piece for piece in self.emitted.pieces if _COMPILE_TIME_CODE.search(piece.text))
        spans = tuple(piece.locate(1, 1) for piece in suspects)
        found = tuple(Diagnostic(Severity.ERROR, "AOS202", message, span, LIMIT_HINT) for span in spans[:1])
        return ModelError(message, code="AOS202", hint=LIMIT_HINT, diagnostics=found)

    def _kept_source(self) -> Path:
        """The emitted file at a place where it can be looked at."""
        kept = self.cache.directory / f"failed-{self.emitted.digest[:16]}.cpp"
        kept.write_text(self.emitted.cpp)
        return kept
