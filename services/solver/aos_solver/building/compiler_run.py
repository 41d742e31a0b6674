"""One run of the compiler: as a child with a deadline, with limits to its memory, its files and its words."""

import asyncio
import os
from collections.abc import Coroutine, Sequence
from pathlib import Path
from typing import Any, TypedDict, Unpack

from aos_protocol.errors import AosError, ModelError, StorageError
from aos_runtime.processes.children import PIPE, Child, Confinement, Limits, guarded
from aos_runtime.sandbox.places import SYSTEM, folders_of_tool, python_folders
from aos_solver.building.compiler import Compiler

LIMIT_HINT = "Look for recursive templates or huge tables in the model code"
"""The advice about a compiler that runs out of time or memory over a model."""

_OUR_LIMIT_HINT = "The machine is too busy or too small for it; try again when less runs"
"""The advice about a compiler that runs out of time or memory over our own sources."""

_DISK_IS_FULL = "No space left on device"
_OUT_OF = (
    "memory exhausted",
    "out of memory",
    "Killed signal",
    "CPU time limit exceeded",
    "File size limit exceeded",
)
_ADDRESS_SPACE_BYTES = 4 << 30
_FILE_BYTES = 512 << 20
_OUTPUT_LIMIT_BYTES = 4 << 20
_STOP_GRACE_S = 30.0
"""The guard of a command that is served last is served late, too. Killed itself, it would leave what the
command has started, and that keeps our pipe open."""


class Given(TypedDict, total=False):
    """The advice where the compiler is too slow, its niceness, each process's limit of processor time, what
    it may read besides its own files, and whether it compiles nothing of documents."""

    hint: str
    niceness: int
    cpu_s: int | None
    reads: Sequence[Path]
    is_ours: bool


async def run_compiler(
    compiler: Compiler,
    command: list[str],
    directory: Path,
    deadline_s: float,
    what: str,
    **given: Unpack[Given],
) -> tuple[str, int]:
    """Runs the command in `directory`, the only folder that it may write in; returns what it says, and its
    status.

    ModelError AOS202, which names `what` is compiled, if it takes longer than `deadline_s`; see `ran_out`.
    """
    memory = None if compiler.family == "zig" else _ADDRESS_SPACE_BYTES
    # The deadline is not of processor time. This limit ends what outlives even the guard. Zig has threads.
    limits = Limits(
        address_space_bytes=memory,
        cpu_s=given.get("cpu_s") or int(deadline_s * 4) + 1,
        file_bytes=_FILE_BYTES,
        niceness=given.get("niceness", 0),
    )
    cache = _zig_cache() if compiler.family == "zig" else None
    confinement = _confinement(compiler, directory, cache, given)
    environment = {
        "LC_ALL": "C",
        "TMPDIR": str(directory),
    }  # What a compiler that is killed leaves goes with it.
    environment["CCACHE_DISABLE"] = "1"  # Its cache is one of the folders that a compiler may not write in.
    if cache is not None:
        environment |= {"ZIG_GLOBAL_CACHE_DIR": str(cache), "ZIG_LOCAL_CACHE_DIR": str(cache)}
    child = await Child.start(
        guarded(command, limits, confinement),
        cwd=directory,
        env=environment,
        stdout=PIPE,
        stderr=asyncio.subprocess.STDOUT,
    )
    try:
        return await child.in_time(_output_and_status(child), deadline_s)
    except TimeoutError as error:
        message = f"the compiler did not finish {what} within {deadline_s:g} s"
        raise ModelError(message, code="AOS202", hint=given.get("hint", _OUR_LIMIT_HINT)) from error
    finally:
        await child.stop(_STOP_GRACE_S)


def _confinement(compiler: Compiler, directory: Path, cache: Path | None, given: Given) -> Confinement:
    """The sandbox of a compiler: it reads the system's folders, its own, and what it compiles."""
    own = folders_of_tool(compiler.command)
    python = python_folders() if compiler.family == "zig" else ()
    return Confinement(
        profile="compiler",
        read=tuple(str(path) for path in given.get("reads", ())),
        execute=(*SYSTEM, *own, *python),
        write=(str(directory), *([str(cache)] if cache is not None else [])),
        is_ours=given.get("is_ours", False),
    )


def _zig_cache() -> Path:
    """The folder in which zig keeps its C++ library, as zig itself chooses it."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    folder = Path(os.environ.get("ZIG_GLOBAL_CACHE_DIR") or Path(home) / "zig")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def ran_out(output: str, status: int) -> bool:
    """Returns whether a compiler ended by a limit to its time, its memory or its files."""
    return status < 0 or status > 128 or any(words in output for words in _OUT_OF)


def internal_error(what: str, output: str, status: int, source: Path) -> AosError:
    """The error for C++ that does not compile although no document is wrong; `source` is where it can be
    looked at."""
    if _DISK_IS_FULL in output:
        hint = "Make space there, or name another folder for compiled models in $AOS_CACHE_DIR"
        return StorageError(f"{what} cannot be compiled: {_DISK_IS_FULL}", hint=hint)
    reason = next(iter(output.strip().splitlines()), f"status {status}")
    report = f"This is not a mistake in the documents; please report it with {source}"
    hint = _OUR_LIMIT_HINT if ran_out(output, status) else report
    return ModelError(f"the C++ of {what} does not compile: {reason}", hint=hint)


async def _output_and_status(child: Child) -> tuple[str, int]:
    return await _read(child), await child.wait()


async def _read(child: Child) -> str:
    """All that the compiler says; what exceeds the limit is read and dropped."""
    kept = bytearray()
    while chunk := await child.stdout.read(65536):
        kept += chunk[: _OUTPUT_LIMIT_BYTES - len(kept)]
    return kept.decode(errors="replace")


async def together(*runs: Coroutine[Any, Any, Any]) -> list[Any]:
    """The results of all; if one fails, the others are stopped and its error is raised."""
    try:
        async with asyncio.TaskGroup() as tasks:
            started = [tasks.create_task(run) for run in runs]
    except ExceptionGroup as errors:
        raise errors.exceptions[0] from None
    return [task.result() for task in started]
