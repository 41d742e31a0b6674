"""The build of a model: from the emitted C++ to an executable, through a cache.

A model is compiled by itself and linked to the engine. The engine is compiled once for all models whose
states have up to so many bytes: it is four times as much code, and models change while a robot waits. The
headers that models include are precompiled with the engine: to read them is a quarter of a model's build.

A model has two builds, which decide alike. The quick build is there sooner. The thorough build makes faster
steps, and hardly faster searches: most of a search is the engine.
"""

import asyncio
import re
import resource
import time
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any, Literal

import msgspec

from aos_protocol.diagnostics import Diagnostic, Severity
from aos_protocol.errors import AosError, ModelError
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.compiler_messages import read_messages, without_line_directives
from aos_solver.building.compiler_run import LIMIT_HINT, Given, internal_error, ran_out, run_compiler
from aos_solver.emission.emit import MODEL_FILE, EmittedModel

SOURCES = Path(__file__).parents[1] / "cpp"
"""The engine, and what emitted models stand on."""

STATE_BYTES = (64, 256)
"""The sizes of states that engines are compiled for; most models fit the first."""
ANY_SIZE = 0
"""Stands for the engine that takes states of every size: each has memory of its own, which takes longer."""
MAX_STATE_BYTES = 1 << 20

SUPPORT = "aos/model/model_support.hpp"
"""Every emitted model includes this file first."""

BuildKind = Literal["quick", "thorough", "unoptimized"]
"""The ways to compile a model; unoptimized code keeps its order."""

_OPTIONS: dict[BuildKind, tuple[str, ...]] = {
    "quick": ("-O1", "-DAOS_QUICK"),
    "thorough": (),
    "unoptimized": ("-O0", "-DAOS_QUICK"),
}

MODEL_CPU_S = 2.0
ENGINE_SHARE = 1 / 20
LINES_PER_CPU_S = 150
"""A quick build may take `MODEL_CPU_S` of processor time, or `ENGINE_SHARE` of the engine's where that is
more, and a second more for `LINES_PER_CPU_S` lines. A model of 200 lines takes half a second, of 700 lines up
to 3 s, all parts of the engine 35 s."""

_ENGINE_DEADLINES = 5
"""The engine has so many times a model's deadline: our own sources are known to end, and only a busy machine
takes long for them."""

_LIMITS = ("-ftemplate-depth=100",)
"""Models' templates need a third of this depth. Document code that recurses without end is told at once."""

_COMPILE_TIME_CODE = re.compile(r"\b(?:template|constexpr|consteval|\w*(?:_constant|_sequence))\b|\]\s*<")

_SECONDS = "cpu_seconds"
"""The file in an engine's entry that says how much processor time its compilation took on this machine."""
_SOURCE = "compiled.cpp"
_OBJECT = "part.o"
_ENGINE_OBJECT = "engine.o"
NUMBERS = ("point_based", "numbers/exact", "numbers/observable_values", "numbers/compact_model")
"""The parts of the engine that know models as numbers only, the same for states of any size: mostly loops."""
_UNCOUNTED = "AOS_UNCOUNTED"
"""Leaves out the code that counts the conditions of rewards and goals (`goal_conditions.py`)."""

_NUMBERS_OPTION = "-O3"
_EXECUTABLE = "model"
_STATE_BYTES_MARK = re.compile(rb"aos-state-bytes:(\d+);")


class BuiltModel(msgspec.Struct, frozen=True):
    """An executable with the emitted text, which stands beside it as `model.cpp`.

    Engines are started with the `mission_values`, in their canonical spelling by the names of parameters'
    parts; the others have their defaults. The executable is the same for all values.
    """

    emitted: EmittedModel
    executable: Path
    is_from_cache: bool
    compile_s: float = 0.0
    mission_values: dict[str, str] = {}

    @property
    def digest(self) -> str:
        """The digest of all that decides about the executable."""
        return self.executable.parent.name.removeprefix("model-")

    @property
    def cache_dir(self) -> Path:
        """The cache that it is an entry of."""
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
    circumstances = _circumstances(compiler)
    names = {
        known: f"model-{digest_of([emitted.cpp, *options, circumstances])}"
        for known, options in _OPTIONS.items()
    }
    for known in ("thorough", "quick") if kind == "quick" else (kind,):
        if (entry := cache.find(names[known])) is not None:
            return BuiltModel(emitted, entry / _EXECUTABLE, is_from_cache=True)
    deadline_s = deadline_s or compiler.deadline_s
    work = _Build(emitted, cache, compiler, on_progress, deadline_s, kind, niceness)
    started_s = time.monotonic()
    made_here: list[Path] = []

    async def make(staging: Path) -> None:
        made_here.append(staging)
        await work.make(staging)

    entry = await cache.fill(
        names[kind],
        make,
        patience_s=_patience_s(compiler, deadline_s),
        on_wait=lambda: on_progress(f"waiting for {emitted.project}, which another process compiles"),
    )
    seconds = time.monotonic() - started_s
    by_whom = "compiled" if made_here else "another process compiled"
    on_progress(f"{by_whom} {emitted.project} in {seconds:.1f} s")
    return BuiltModel(emitted, entry / _EXECUTABLE, is_from_cache=not made_here, compile_s=seconds)


async def build_engine(
    cache_dir: Path,
    *,
    compiler: Compiler | None = None,
    on_progress: Callable[[str], None] = lambda text: None,
    state_bytes: int = STATE_BYTES[0],
) -> Path:
    """The directory of the engine's object files for states of up to `state_bytes`; errors as in `build`.

    What does not depend on states is only in that of the smallest size.
    Setting up a machine calls it for the smallest and for `ANY_SIZE`, so that no model waits for its engine.
    """
    compiler = compiler or await find_compiler()

    async def make(staging: Path) -> None:
        on_progress(f"compiling the engine with {compiler.version}, once for all models")
        if compiler.family == "zig":
            on_progress("ziglang's first build prepares its C++ library as well; allow some minutes")
        options = [f"-DAOS_STATE_BYTES={state_bytes}", *compiler.large_source]
        commands = [_part(compiler, _ENGINE_OBJECT, "engine", *options)]
        if state_bytes == STATE_BYTES[0]:
            commands += [_part(compiler, number_object(part), part, _NUMBERS_OPTION) for part in NUMBERS]
            (staging / SUPPORT).parent.mkdir(parents=True)
            commands.append(compiler.precompilation(SUPPORT, str(SOURCES), ".", *_OPTIONS["quick"]))
        deadline_s = _ENGINE_DEADLINES * compiler.deadline_s
        before_s = _children_cpu_s()
        ours: Given = {"reads": [SOURCES], "is_ours": True}
        runs = [
            run_compiler(compiler, command, staging, deadline_s, "the engine", **ours) for command in commands
        ]
        for output, status in await _together(*runs):
            if status != 0:
                raise internal_error("the engine", output, status, SOURCES / "engine.cpp")
        (staging / _SECONDS).write_text(f"{_children_cpu_s() - before_s:.1f}")

    return await BuildCache(cache_dir).fill(
        _engine_name(compiler, state_bytes),
        make,
        patience_s=_ENGINE_DEADLINES * compiler.deadline_s,
        on_wait=lambda: on_progress("waiting for the engine, which another process compiles"),
    )


def _patience_s(compiler: Compiler, deadline_s: float) -> float:
    """Returns how long another process is waited for that makes the same model: as long as it may take."""
    return _ENGINE_DEADLINES * compiler.deadline_s + 2 * deadline_s


def number_object(part: str) -> str:
    """Returns the name of the object file of one of `NUMBERS`."""
    return f"{Path(part).name}.o"


def _part(compiler: Compiler, made: str, source: str, *options: str) -> list[str]:
    """The command that compiles a part of the engine."""
    return compiler.compilation(str(SOURCES / f"{source}.cpp"), made, str(SOURCES), *options)


def _engine_name(compiler: Compiler, state_bytes: int) -> str:
    # Clang looks for what was precompiled by the path of the sources.
    place = [] if compiler.family == "gcc" else [str(SOURCES)]
    options = [_NUMBERS_OPTION, *compiler.large_source]
    return f"engine-{state_bytes}-{digest_of([_circumstances(compiler), *options, *place])}"


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
        usual, _ = await _together(self._engine(STATE_BYTES[0]), self._compile(staging))
        state_bytes = self._state_bytes(staging / _OBJECT)
        engine = usual if state_bytes == STATE_BYTES[0] else await self._engine(self._ready_size(state_bytes))
        numbers = [usual / number_object(part) for part in NUMBERS]
        await self._link(staging, [engine / _ENGINE_OBJECT, *numbers])

    def _ready_engine(self, state_bytes: int) -> Path | None:
        return self.cache.find(_engine_name(self.compiler, state_bytes))

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
        if self.kind != "quick":
            return None
        engine_s = _engine_seconds(self._ready_engine(STATE_BYTES[0]))
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
            return ModelError(
                f"the model code of {project} does not compile",
                hint="Mend the places named",
                diagnostics=report.diagnostics,
            )
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


def _engine_seconds(entry: Path | None) -> float:
    """Returns the processor time that this machine took to compile the engine; 0 where nobody has looked."""
    try:
        return float((entry / _SECONDS).read_text()) if entry is not None else 0.0
    except (OSError, ValueError):
        return 0.0


def _children_cpu_s() -> float:
    """The processor time of the children that have ended: while an engine is compiled, of its compilers. By
    the wall clock, a machine with other work would let a hostile model compile ten times as long."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _circumstances(compiler: Compiler) -> str:
    """The digest of what decides about a result besides the model's text."""
    files = sorted(path for path in SOURCES.rglob("*") if path.suffix in (".hpp", ".cpp"))
    texts = [part for path in files for part in (str(path.relative_to(SOURCES)), path.read_text())]
    return digest_of([compiler.version, *compiler.compilation("", "", ""), *texts])


async def _together(*runs: Coroutine[Any, Any, Any]) -> list[Any]:
    """The results of all; if one fails, the others are stopped and its error is raised."""
    try:
        async with asyncio.TaskGroup() as tasks:
            started = [tasks.create_task(run) for run in runs]
    except ExceptionGroup as errors:
        raise errors.exceptions[0] from None
    return [task.result() for task in started]
