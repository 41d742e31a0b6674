import asyncio
import subprocess
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import Compiler, find_compiler
from aos_solver.building.engine_build import NUMBERS, SOURCES, build_engine, object_of

PATIENCE_S = 800.0
"""Another process that compiles the same is waited for."""


async def built_program(cache_dir: Path, source: Path, *options: str, includes: Iterable[Path] = ()) -> Path:
    """The executable of a source file, from the cache or compiled now.

    It may include the engine's headers, its own folder and those of `includes`. What the engine
    has of numbers is linked to it.
    """
    compiler = await find_compiler()
    folders = [source.parent, *includes]
    more = [*options, *compiler.without_collections, *(f"-I{folder}" for folder in folders)]
    engine = await build_engine(cache_dir, compiler=compiler)

    async def make(staging: Path):
        compilation = compiler.compilation(str(source), "part.o", str(SOURCES), *more)
        await asyncio.to_thread(run, compilation, staging)
        numbers = str(engine / object_of(NUMBERS))
        run(compiler.linking(["part.o", numbers], source.stem), staging)

    name = f"{source.stem}-{digest_of([source.name, *more, *what_decides(compiler, *folders)])}"
    return await BuildCache(cache_dir).fill(name, make, patience_s=PATIENCE_S) / source.stem


def what_decides(compiler: Compiler, *folders: Path) -> list[str]:
    """Returns what decides about the result of a compilation besides its options, for a cache's key."""
    texts = (text for folder in (SOURCES, *folders) for text in _texts(folder))
    return [compiler.version, *compiler.compilation("", "", ""), *texts]


@cache
def _texts(folder: Path) -> list[str]:
    return [path.read_text() for path in sorted(folder.rglob("*.[ch]pp"))]


def run(command: list[str], folder: Path):
    """Runs a compiler's command; its messages are the error."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE_S)
    if done.returncode != 0:
        raise RuntimeError(f"it does not compile: {' '.join(command)}\n{done.stderr}")
