"""Compiles the solver once, and runs it on a model: bounds over time, and the alpha vectors in the end."""

import asyncio
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from aos_protocol.errors import ModelError, PlanningError
from aos_runtime.processes.children import PIPE, Child, Limits, guarded
from aos_solver.building.build_cache import BuildCache, digest_of
from aos_solver.building.compiler import find_compiler
from aos_solver.building.compiler_run import internal_error, run_compiler
from aos_solver.building.engine_build import SOURCES
from aos_solver.child.process.confinement import confinement_of
from aos_solver.offline.alpha_vectors import AlphaVectors, RegionSize
from aos_solver.offline.explicit_model import ExplicitModel

_ADDRESS_SPACE_BYTES = 16 << 30
_LINE_LIMIT_BYTES = 1 << 16
_CROSSED_STATUS = 3
_LARGEST = 1e300
"""Sums of returns up to this one are far from the end of the floating-point numbers."""


class SolvingLimits(msgspec.Struct, frozen=True, kw_only=True):
    """The limits of solving: bounds nearer than `precision`, `cpu_s` seconds of computing, so much memory.

    Without a `precision` it is 0.001, times the largest reward where that is below 1.
    """

    precision: float | None = None
    cpu_s: float = 60.0
    memory_bytes: int = 2 << 30


class Bounds(msgspec.Struct, frozen=True):
    """The bounds that are known after so many seconds of computing: the policy gives at least `lower` from
    the start, and no policy gives more than `upper`. Both are discounted."""

    seconds: float
    lower: float
    upper: float
    vectors: int
    beliefs: int
    backups: int
    ending: Literal["", "precision", "settled", "time", "memory", "stopped"]

    @property
    def gap(self) -> float:
        return self.upper - self.lower


class Solution(msgspec.Struct, frozen=True):
    """The last bounds, all bounds in their order, and the policy."""

    bounds: Bounds
    history: tuple[Bounds, ...]
    vectors: AlphaVectors


class _Regions(msgspec.Struct, frozen=True):
    """The line before the vectors in the solver's file."""

    regions: tuple[RegionSize, ...]


async def solve(
    model: ExplicitModel,
    limits: SolvingLimits,
    *,
    cache_dir: Path,
    on_progress: Callable[[Bounds], None] = lambda bounds: None,
    stop: asyncio.Event | None = None,
) -> Solution:
    """Solves until a limit is reached or `stop` is set, and keeps the best so far.

    PlanningError AOS320 for a discount or rewards that it cannot do, AOS302 if the mission is over at the
    start.
    """
    check_discount(model.name, model.discount)
    largest = np.abs(model.rewards).max(initial=0.0)
    if largest > _LARGEST * (1 - model.discount):
        hint = "Divide all rewards by one number"
        raise PlanningError(f"returns of {model.name} are too large to be added up", code="AOS320", hint=hint)
    if not model.starts:
        raise PlanningError(f"{model.name} is over at the start")
    executable = await build_solver(cache_dir)
    with tempfile.TemporaryDirectory(prefix="aos-solve-") as folder:
        flat, found = Path(folder) / "model.flat", Path(folder) / "vectors"
        await asyncio.to_thread(model.write_flat, flat)
        numbers = [repr(precision_of(model, limits)), repr(limits.cpu_s), str(limits.memory_bytes)]
        with found.open("wb") as vectors_file:
            written = vectors_file.fileno()
            command = [str(executable), str(flat), str(written), *numbers]
            history = await _run(command, on_progress, stop or asyncio.Event(), reads=flat, writes=written)
        line, _, data = found.read_bytes().partition(b"\n")
        sizes = msgspec.json.decode(line, type=_Regions).regions
        vectors = AlphaVectors.of_bytes(len(model.actions), sizes, data)
    return Solution(history[-1], tuple(history), vectors)


def precision_of(model: ExplicitModel, limits: SolvingLimits) -> float:
    """The precision that the limits have, or that is usual for rewards of this size."""
    largest = float(np.abs(model.rewards).max(initial=0.0))
    return min(largest, 1.0) * 1e-3 if limits.precision is None else limits.precision


def check_discount(name: str, discount: float) -> None:
    """Raises PlanningError AOS320 for a discount with which the model of this name cannot be solved."""
    if not 0 <= discount < 1:
        message = f"{name} has the discount {discount:.16g}, and values without an end have no bounds"
        hint = "Solve it with a discount below 1, for example --discount 0.99"
        raise PlanningError(message, code="AOS320", hint=hint)


async def _run(
    command: list[str],
    on_progress: Callable[[Bounds], None],
    stop: asyncio.Event,
    *,
    reads: Path,
    writes: int,
) -> list[Bounds]:
    """All lines of the solver; it ends in order when its input is closed."""
    child = await Child.start(
        guarded(
            command, Limits(address_space_bytes=_ADDRESS_SPACE_BYTES), confinement_of(Path(command[0]), reads)
        ),
        name="sarsop",
        pass_fds=[writes],
        stdin=PIPE,
        stdout=PIPE,
        stderr=PIPE,
        stream_limit_bytes=_LINE_LIMIT_BYTES,
    )
    history: list[Bounds] = []
    stopping = asyncio.create_task(_close_when(stop, child))
    try:
        while line := await child.stdout.readline():
            history.append(msgspec.json.decode(line, type=Bounds))
            on_progress(history[-1])
        problem = (await child.stderr.read()).decode(errors="replace").strip()
        status = await child.wait()
    finally:
        stopping.cancel()
        await child.stop()
    if status != 0 or not history:
        reason = problem or f"it ended with status {status}"
        code = "AOS216" if status == _CROSSED_STATUS else "AOS213"
        raise ModelError(f"the solver failed: {reason}", code=code)
    return history


async def _close_when(stop: asyncio.Event, child: Child) -> None:
    await stop.wait()
    child.stdin.close()


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
