"""From the emitted C++ to an executable, through a cache that several processes may share.

An entry of the cache is a directory that appears at once, by a rename, when everything in it is complete.
Its name is the digest of all that decides about the result: the text, the engine's headers, the compiler and
its flags.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path

import msgspec

from aos_protocol.errors import ModelError
from aos_runtime.children import PIPE, Child, Limits, guarded
from aos_solver.compiler import Compiler, find_compiler
from aos_solver.compiler_messages import read_messages, without_line_directives
from aos_solver.emit import MODEL_FILE, EmittedModel

__all__ = ["ENGINE_HEADERS", "BuiltModel", "build"]

ENGINE_HEADERS = Path(__file__).parent / "cpp"
"""The include directory of the engine and of what emitted models stand on."""

_OPTIMIZE = "-O2"
_SOURCE = "compiled.cpp"
_EXECUTABLE = "model"
_ADDRESS_SPACE_BYTES = 4 << 30
_FILE_BYTES = 512 << 20
_OUTPUT_LIMIT_BYTES = 4 << 20
_ABANDONED_AFTER_S = 3600.0


class BuiltModel(msgspec.Struct, frozen=True):
    """An executable with the emitted text, which stands beside it as `model.cpp`."""

    emitted: EmittedModel
    executable: Path
    is_from_cache: bool
    compile_s: float = 0.0


async def build(
    emitted: EmittedModel,
    *,
    cache_dir: Path,
    compiler: Compiler | None = None,
    on_progress: Callable[[str], None] = lambda text: None,
    include_dir: Path = ENGINE_HEADERS,
    deadline_s: float | None = None,
) -> BuiltModel:
    """The executable of a model, from the cache or compiled now.

    ModelError AOS201 carries the compiler's errors as diagnostics at the documents' places, or names the
    emitted file where an error is not in document code; AOS202 when the compiler ran out of time or memory;
    AOS203 without a compiler.
    """
    compiler = compiler or await find_compiler()
    entry = cache_dir / _key(emitted, compiler, include_dir)
    executable = entry / _EXECUTABLE
    if executable.exists():
        return BuiltModel(emitted, executable, is_from_cache=True)
    _announce(emitted, compiler, on_progress)
    _remove_abandoned(cache_dir)
    staging = cache_dir / f"{entry.name}.{os.getpid()}.{time.monotonic_ns()}.building"
    staging.mkdir(parents=True)
    started_s = time.monotonic()
    try:
        (staging / MODEL_FILE).write_text(emitted.cpp)
        await _compile(emitted, compiler, staging, include_dir, deadline_s or compiler.deadline_s)
        _move_into_place(staging, entry)
    finally:
        shutil.rmtree(staging, ignore_errors=True)
    seconds = time.monotonic() - started_s
    on_progress(f"compiled {emitted.project} in {seconds:.1f} s")
    return BuiltModel(emitted, executable, is_from_cache=False, compile_s=seconds)


def _key(emitted: EmittedModel, compiler: Compiler, include_dir: Path) -> str:
    digest = hashlib.sha256()
    parts = [emitted.cpp, compiler.version, *compiler.command, *compiler.flags(_OPTIMIZE)]
    for header in sorted(include_dir.rglob("*.hpp")):
        parts += [str(header.relative_to(include_dir)), header.read_text()]
    for part in parts:
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()[:32]


def _announce(emitted: EmittedModel, compiler: Compiler, on_progress: Callable[[str], None]) -> None:
    on_progress(f"compiling {emitted.project} with {compiler.version}")
    if compiler.family == "zig":
        on_progress("ziglang prepares its C++ library for its first build, which takes about a minute")


async def _compile(
    emitted: EmittedModel, compiler: Compiler, staging: Path, include_dir: Path, deadline_s: float
) -> None:
    (staging / _SOURCE).write_text(without_line_directives(emitted.cpp))
    command = compiler.arguments(
        optimize=_OPTIMIZE, include=str(include_dir), source=_SOURCE, output=_EXECUTABLE
    )
    memory = None if compiler.family == "zig" else _ADDRESS_SPACE_BYTES
    limits = Limits(address_space_bytes=memory, cpu_s=int(deadline_s) + 1, file_bytes=_FILE_BYTES)
    child = await Child.start(
        guarded(command, limits),
        cwd=staging,
        env={"LC_ALL": "C"},
        stdout=PIPE,
        stderr=asyncio.subprocess.STDOUT,
    )
    try:
        async with asyncio.timeout(deadline_s):
            output = await _read(child)
            status = await child.wait()
    except TimeoutError as error:
        raise ModelError(
            f"the compiler did not finish {emitted.project} within {deadline_s:g} s",
            code="AOS202",
            hint="Look for recursive templates or huge tables in the model code",
        ) from error
    finally:
        await child.stop()
    if status != 0:
        raise _failure(emitted, output, status, staging)
    (staging / _SOURCE).unlink()


async def _read(child: Child) -> str:
    """All that the compiler says; what exceeds the limit is read and dropped."""
    kept = bytearray()
    while chunk := await child.stdout.read(65536):
        kept += chunk[: _OUTPUT_LIMIT_BYTES - len(kept)]
    return kept.decode(errors="replace")


def _failure(emitted: EmittedModel, output: str, status: int, staging: Path) -> ModelError:
    report = read_messages(output, _SOURCE, emitted)
    if report.diagnostics:
        return ModelError(
            f"the model code of {emitted.project} does not compile",
            hint="Mend the places named",
            diagnostics=report.diagnostics,
        )
    if status < 0 or status > 128 or "memory exhausted" in output or "out of memory" in output:
        return ModelError(
            f"the compiler ran out of time or memory on {emitted.project}",
            code="AOS202",
            hint="Look for recursive templates or huge tables in the model code",
        )
    kept = staging.parent / f"failed-{emitted.digest[:16]}.cpp"
    kept.write_text(emitted.cpp)
    reason = next(iter(report.outside or output.strip().splitlines()), f"status {status}")
    return ModelError(
        f"the emitted model of {emitted.project} does not compile: {reason}",
        hint=f"This is not a mistake in the documents; please report it with {kept}",
    )


def _move_into_place(staging: Path, entry: Path) -> None:
    try:
        staging.rename(entry)
    except OSError:
        # Another process was quicker with the same model.
        if not (entry / _EXECUTABLE).exists():
            raise


def _remove_abandoned(cache_dir: Path) -> None:
    """Removes what builds left behind that were killed."""
    for path in cache_dir.glob("*.building"):
        with contextlib.suppress(OSError):
            if time.time() - path.stat().st_mtime > _ABANDONED_AFTER_S:
                shutil.rmtree(path, ignore_errors=True)
