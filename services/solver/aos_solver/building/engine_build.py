"""The build of the engine, once for all models whose states have up to so many bytes.

It is four times as much code as a model, and models change while a robot waits. The headers that models
include are precompiled with it: to read them is a quarter of a model's build.
"""

import asyncio
import os
import resource
from collections.abc import Callable, Iterator
from functools import lru_cache
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

ENGINE = "engine"
"""The part that holds states: each size of them has its own. It takes two thirds of the time."""
NUMBERS = "numbers"
"""The part that knows models as numbers only: mostly loops."""
FUNCTIONS = "support"
"""The part with the functions that models call."""

_PART_BYTES = 1500 << 20
"""The longest part takes 1.1 GB of memory."""

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
        commands = [_part(compiler, ENGINE, f"-DAOS_STATE_BYTES={state_bytes}", *compiler.largest_source)]
        if state_bytes == STATE_BYTES[0]:
            commands.append(_part(compiler, NUMBERS, *compiler.without_collections))
            commands.append(_part(compiler, FUNCTIONS, *compiler.large_source))
            (staging / SUPPORT).parent.mkdir(parents=True)
            commands.append(compiler.precompilation(SUPPORT, str(SOURCES), ".", *QUICK))
        deadline_s = engine_deadline_s(compiler)
        before_s = _children_cpu_s()
        ours: Given = {"reads": [SOURCES], "is_ours": True}
        places = asyncio.Semaphore(_at_once())

        async def compile_part(command: list[str]) -> None:
            async with places:
                run = run_compiler(compiler, command, staging, deadline_s, "the engine", **ours)
                output, status = await run
                if status != 0:
                    raise internal_error("the engine", output, status, SOURCES / "engine.cpp")

        # The longest come first and keep a processor each. They would end later if all began together.
        await together(*(compile_part(command) for command in commands))
        (staging / _SECONDS).write_text(f"{_children_cpu_s() - before_s:.1f}")

    return await BuildCache(cache_dir).fill(
        engine_name(compiler, state_bytes),
        make,
        patience_s=2 * engine_deadline_s(compiler),
        on_wait=lambda: on_progress("waiting for the engine, which another process compiles"),
    )


def engine_deadline_s(compiler: Compiler) -> float:
    """Returns how long the longest part of the engine may take; all others take less than that together."""
    return _MODEL_DEADLINES * compiler.deadline_s


def object_of(part: str) -> str:
    """Returns the name of a part's object file."""
    return f"{part}.o"


def objects_of(usual: Path, engine: Path) -> list[Path]:
    """Returns all object files of an engine; `usual` is the directory of the smallest."""
    return [engine / object_of(ENGINE), usual / object_of(NUMBERS), usual / object_of(FUNCTIONS)]


def engine_name(compiler: Compiler, state_bytes: int) -> str:
    """The name of the engine's entry in a cache."""
    # Clang looks for what was precompiled by the path of the sources.
    place = [] if compiler.family == "gcc" else [str(SOURCES)]
    return f"engine-{state_bytes}-{digest_of([circumstances(compiler), *compiler.largest_source, *place])}"


def engine_seconds(entry: Path | None) -> float:
    """Returns the processor time that this machine took to compile the engine; 0 where nobody has looked."""
    try:
        return float((entry / _SECONDS).read_text()) if entry is not None else 0.0
    except (OSError, ValueError):
        return 0.0


def circumstances(compiler: Compiler) -> str:
    """The digest of what decides about a result besides the model's text."""
    return _digest_of_sources(compiler, tuple(_stamps(SOURCES)))


def _stamps(folder: str | Path) -> Iterator[tuple[str, int, int]]:
    """Yields the path of each source below a folder, the time of its last change, and its size."""
    with os.scandir(folder) as found:
        for each in found:
            if each.is_dir():
                yield from _stamps(each.path)
            elif each.name.endswith((".hpp", ".cpp")):
                status = each.stat()
                yield each.path, status.st_mtime_ns, status.st_size


@lru_cache
def _digest_of_sources(compiler: Compiler, stamps: tuple[tuple[str, int, int], ...]) -> str:
    """Each model that is built or looked for asks. Who changes sources meanwhile changes their stamps."""
    files = sorted(Path(path) for path, *_ in stamps)
    texts = [part for path in files for part in (str(path.relative_to(SOURCES)), path.read_text())]
    return digest_of([compiler.version, *compiler.compilation("", "", ""), *texts])


def _part(compiler: Compiler, part: str, *options: str) -> list[str]:
    return compiler.compilation(str(SOURCES / f"{part}.cpp"), object_of(part), str(SOURCES), *options)


def _at_once() -> int:
    """Returns how many parts are compiled at a time: as many as there are processors and memory for."""
    memory_bytes = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return max(1, min(len(os.sched_getaffinity(0)), memory_bytes // _PART_BYTES))


def _children_cpu_s() -> float:
    """The processor time of the children that have ended: while an engine is compiled, of its compilers. By
    the wall clock, a machine with other work would let a hostile model compile ten times as long."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
