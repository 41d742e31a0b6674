"""The build of the engine, once for all models whose states have up to so many bytes.

It is four times as much code as a model, and models change while a robot waits. The headers that models
include are precompiled with it: to read them is a quarter of a model's build.
"""

import resource
from collections.abc import Callable
from pathlib import Path

from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.compiler_run import Given, internal_error, run_compiler, together

SOURCES = Path(__file__).parents[1] / "cpp"
"""The engine, and what emitted models stand on."""

STATE_BYTES = (64, 256)
"""The sizes of states that engines are compiled for; most models fit the first."""
ANY_SIZE = 0
"""Stands for the engine that takes states of every size: each has memory of its own, which takes longer."""
SUPPORT = "aos/model/model_support.hpp"
"""Every emitted model includes this file first."""

QUICK = ("-O1", "-DAOS_QUICK")
"""The options of a quick build, with which what models include is precompiled."""

ENGINE_OBJECT = "engine.o"
NUMBERS = ("point_based", "numbers/exact", "numbers/observable_values", "numbers/compact_model")
"""The parts of the engine that know models as numbers only, the same for states of any size: mostly loops."""
_NUMBERS_OPTION = "-O3"

_MODEL_DEADLINES = 5
"""The engine has so many times a model's deadline: our own sources are known to end, and only a busy machine
takes long for them."""

_SECONDS = "cpu_seconds"
"""The file in an engine's entry that says how much processor time its compilation took on this machine."""


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
        commands = [_part(compiler, ENGINE_OBJECT, "engine", *options)]
        if state_bytes == STATE_BYTES[0]:
            commands += [_part(compiler, number_object(part), part, _NUMBERS_OPTION) for part in NUMBERS]
            (staging / SUPPORT).parent.mkdir(parents=True)
            commands.append(compiler.precompilation(SUPPORT, str(SOURCES), ".", *QUICK))
        deadline_s = engine_deadline_s(compiler)
        before_s = _children_cpu_s()
        ours: Given = {"reads": [SOURCES], "is_ours": True}
        runs = [
            run_compiler(compiler, command, staging, deadline_s, "the engine", **ours) for command in commands
        ]
        for output, status in await together(*runs):
            if status != 0:
                raise internal_error("the engine", output, status, SOURCES / "engine.cpp")
        (staging / _SECONDS).write_text(f"{_children_cpu_s() - before_s:.1f}")

    return await BuildCache(cache_dir).fill(
        engine_name(compiler, state_bytes),
        make,
        patience_s=engine_deadline_s(compiler),
        on_wait=lambda: on_progress("waiting for the engine, which another process compiles"),
    )


def engine_deadline_s(compiler: Compiler) -> float:
    """Returns how long the compilation of the engine may take."""
    return _MODEL_DEADLINES * compiler.deadline_s


def number_object(part: str) -> str:
    """Returns the name of the object file of one of `NUMBERS`."""
    return f"{Path(part).name}.o"


def engine_name(compiler: Compiler, state_bytes: int) -> str:
    """The name of the engine's entry in a cache."""
    # Clang looks for what was precompiled by the path of the sources.
    place = [] if compiler.family == "gcc" else [str(SOURCES)]
    options = [_NUMBERS_OPTION, *compiler.large_source]
    return f"engine-{state_bytes}-{digest_of([circumstances(compiler), *options, *place])}"


def engine_seconds(entry: Path | None) -> float:
    """Returns the processor time that this machine took to compile the engine; 0 where nobody has looked."""
    try:
        return float((entry / _SECONDS).read_text()) if entry is not None else 0.0
    except (OSError, ValueError):
        return 0.0


def circumstances(compiler: Compiler) -> str:
    """The digest of what decides about a result besides the model's text."""
    files = sorted(path for path in SOURCES.rglob("*") if path.suffix in (".hpp", ".cpp"))
    texts = [part for path in files for part in (str(path.relative_to(SOURCES)), path.read_text())]
    return digest_of([compiler.version, *compiler.compilation("", "", ""), *texts])


def _part(compiler: Compiler, made: str, source: str, *options: str) -> list[str]:
    """The command that compiles a part of the engine."""
    return compiler.compilation(str(SOURCES / f"{source}.cpp"), made, str(SOURCES), *options)


def _children_cpu_s() -> float:
    """The processor time of the children that have ended: while an engine is compiled, of its compilers. By
    the wall clock, a machine with other work would let a hostile model compile ten times as long."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
