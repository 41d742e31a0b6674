"""The solver's executable: compiled once, from the sources beside this file."""

from collections.abc import Callable
from pathlib import Path

from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import find_compiler
from aos_solver.building.compiler_run import internal_error, run_compiler
from aos_solver.building.engine_build import SOURCES

_SOURCE = Path(__file__).parent / "cpp" / "sarsop.cpp"
_ROOMS = ("aos/base", "aos/draws", "aos/text", "point_based")
"""Rooms of the headers that it includes."""
_OBJECT = "sarsop.o"
_EXECUTABLE = "sarsop"


async def build_solver(cache_dir: Path, on_progress: Callable[[str], None] = lambda remark: None) -> Path:
    """The executable, from the cache or compiled now.

    ModelError AOS202 when the compiler ran out of time, AOS203 without a compiler.
    """
    compiler = await find_compiler()
    compilation = compiler.compilation(str(_SOURCE), _OBJECT, str(SOURCES), "-O3")
    texts = [path.read_text() for path in _sources()]
    options = compiler.compilation("", "", "", "-O3")
    name = f"sarsop-{digest_of([compiler.version, *options, *texts])}"

    async def make(staging: Path) -> None:
        on_progress(f"compiling the solver with {compiler.version}, once for all models")
        for command in (compilation, compiler.linking([_OBJECT], _EXECUTABLE)):
            output, status = await run_compiler(
                compiler,
                command,
                staging,
                compiler.deadline_s,
                "the solver",
                reads=[SOURCES, _SOURCE.parent],
                is_ours=True,
            )
            if status != 0:
                raise internal_error("the solver", output, status, _SOURCE)
        (staging / _EXECUTABLE).chmod(0o755)

    return await BuildCache(cache_dir).fill(name, make) / _EXECUTABLE


def _sources() -> list[Path]:
    return [
        path
        for room in (_SOURCE.parent, *(SOURCES / name for name in _ROOMS))
        for path in sorted(room.iterdir())
    ]
