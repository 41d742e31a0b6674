"""The process that runs one built model: a line of text there, a line of JSON back.

Every question has a deadline; a crash, a hang and an exit become a ModelError that names the document place
that ran.
"""

import asyncio
import signal
import sys
from collections.abc import Callable
from typing import BinaryIO, Literal, Self, TypeVar

import msgspec
from msgspec.structs import replace

from aos_protocol import errors
from aos_protocol.codec import UNREADABLE
from aos_protocol.diagnostics import Diagnostic, Severity
from aos_runtime.processes.children import PIPE, Child, Limits, guarded
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.models import EngineDescription, EngineFault, Progress
from aos_solver.child.lines.belief_draws import draws_of
from aos_solver.child.process.confinement import confinement_of
from aos_solver.child.process.shared_memory import SharedMemory, new_blame_page, running_piece

ImpossiblePolicy = Literal["hold", "widen", "reset"]

A = TypeVar("A")

START_DEADLINE_S = 20.0
EXIT_DEADLINE_S = 2.0
FROZEN_S = 5.0
"""A child is looked at so often while it is asked: one that a signal has frozen is killed."""
HANG_STATUS = 71
"""A child whose document code ran too long ends with this status; known to watchdog.hpp."""
REACHING_STATUS = 72
"""A child whose document code reached for what it may not ends with this status; known to reaching.hpp."""
HANG_PERIODS = 12
"""A call of document code may take this many tenths of a second of processor time."""

ADDRESS_SPACE_BYTES = 8 * 1024**3
SHARED_BYTES = 8 * 1024**3
"""The most that a child writes to one memory that it shares; kept_beliefs.hpp knows it."""

_LIMITS = Limits(address_space_bytes=ADDRESS_SPACE_BYTES, file_bytes=SHARED_BYTES)

ANSWER_LIMIT_BYTES = 32 * 1024**2
"""The most that one answer has. What may be longer comes in pieces."""

_MEMORY_HINT = (
    "Document code that writes past a plain array or through a pointer may have harmed the engine's memory "
    "before: look for such code. If there is none, this is a mistake of AOS; please report it with the "
    "bundle, the command with its seed, and this message"
)
_REPORT_HINT = (
    "This is a mistake of AOS and not of the documents; please report it with the bundle, the command with "
    "its seed, and this message"
)


_REACHING = "this code reaches for what models may not: a file, a connection, another process"


class _FaultAnswer(msgspec.Struct, frozen=True):
    fault: EngineFault | None = None


class _ProgressLine(msgspec.Struct, frozen=True):
    progress: Progress


_PROGRESS_LINE = b'{"progress":'


class EngineStart(msgspec.Struct, frozen=True):
    """The start of a child. It keeps its beliefs in the one memory, and writes listings to the other.

    `mission_values` are those of mission parameters, as `parameter_arguments` writes them. With a `niceness`
    of up to 19 the child leaves the processor to others.
    """

    seed: int
    policy: ImpossiblePolicy
    beliefs: SharedMemory | None = None
    listing: SharedMemory | None = None
    mission_values: tuple[str, ...] = ()
    niceness: int = 0


class KilledError(errors.ModelError):
    """The child was killed or frozen from outside, not by model code, so asking another one is right."""


class OverdueError(errors.EndlessCodeError):
    """No answer within the processor time that was allowed: what ran may come to an end later."""


class EngineChild:
    """A running child. After an error it may be gone (`is_running`); nobody asks two things at once."""

    description: EngineDescription

    def __init__(self, built: BuiltModel, blame: SharedMemory, child: Child) -> None:
        self._built = built
        self._child = child
        self._blame: SharedMemory | None = blame
        self._looking: asyncio.TimerHandle
        self._was_frozen = False
        self._printed = asyncio.create_task(pass_on(child.stderr, sys.stderr.buffer))

    @classmethod
    async def start(cls, built: BuiltModel, start: EngineStart) -> Self:
        """A child on the initial belief; ModelError if the model cannot even begin."""
        engine = await cls.launch(built, start)
        try:
            await engine.begin(START_DEADLINE_S)
        except BaseException:
            await engine.close()
            raise
        return engine

    @classmethod
    async def launch(cls, built: BuiltModel, start: EngineStart, periods: int = HANG_PERIODS) -> Self:
        """A child of which nobody knows yet whether it can `begin`."""
        blame = new_blame_page()
        shared = [memory.descriptor for memory in (blame, start.beliefs, start.listing) if memory is not None]
        kept = -1 if start.beliefs is None else start.beliefs.descriptor
        arguments = [str(blame.descriptor), str(kept), str(draws_of(start.seed)), start.policy, str(periods)]
        arguments += start.mission_values
        limits = replace(_LIMITS, niceness=start.niceness or None)
        try:
            child = await Child.start(
                guarded([str(built.executable), *arguments], limits, confinement_of(built.executable)),
                name="engine",
                pass_fds=shared,
                stdin=PIPE,
                stdout=PIPE,
                stderr=PIPE,
                stream_limit_bytes=ANSWER_LIMIT_BYTES,
            )
        except BaseException:
            blame.close()
            raise
        return cls(built, blame, child)

    async def begin(self, deadline_s: float) -> None:
        """Waits for the initial belief; ModelError if the model has none."""
        self.description = await self.ask(None, EngineDescription, deadline_s)

    @property
    def pid(self) -> int:
        """The guarded child's process id."""
        return self._child.pid

    @property
    def is_running(self) -> bool:
        return self._blame is not None and self._child.returncode is None

    @property
    def running_piece(self) -> int:
        """The number of the document code that runs now or ran last, 0 for none; of threads, the first's."""
        return 0 if self._blame is None else running_piece(self._blame)

    def ran_s(self) -> float:
        """Returns for how long it had a processor; 0 where the kernel is silent."""
        return self._child.ran_s()

    async def ask(
        self,
        command: str | None,
        kind: type[A],
        deadline_s: float,
        on_progress: Callable[[Progress], None] | None = None,
    ) -> A:
        """The answer to a command, or to none; ModelError for a fault of model code.

        `on_progress` is told how far the work is, some times a second while it goes on.
        """
        self._look_later()
        try:
            line = await self._child.in_time(self._answer(command, on_progress), deadline_s)
        except TimeoutError:
            text = f"the model did not finish within {deadline_s:.0f} s"
            raise await self._lost(errors.EndlessCodeError, text) from None
        except (ConnectionError, ValueError):
            line = b""
        finally:
            self._looking.cancel()
        if not line.endswith(b"\n"):
            raise await self._lost(errors.CodeFaultError, "model code ended the engine")
        return self._decoded(line, kind)

    async def _answer(self, command: str | None, on_progress: Callable[[Progress], None] | None) -> bytes:
        child = self._child
        if command is not None:
            child.stdin.write(command.encode() + b"\n")
            await child.stdin.drain()
        while (line := await child.stdout.readline()).startswith(_PROGRESS_LINE):
            if on_progress is not None:
                on_progress(self._decoded(line, _ProgressLine).progress)
        return line

    def _look_later(self) -> None:
        self._looking = asyncio.get_running_loop().call_later(FROZEN_S, self._end_if_frozen)

    def _end_if_frozen(self) -> None:
        """Ends a child that may stay frozen for ever: another one has the belief at once."""
        if self._child.is_frozen():
            self._was_frozen = True
            self._child.end_at_once()
        else:
            self._look_later()

    async def close(self) -> None:
        """Ends the child; closing twice does nothing."""
        self._child.end_at_once()
        if not await self._child.wait_for(EXIT_DEADLINE_S):
            self._child.kill()
            await self._child.wait()
        await asyncio.wait({self._printed}, timeout=EXIT_DEADLINE_S)
        self._printed.cancel()
        if self._blame is not None:
            self._blame.close()
            self._blame = None

    def fault(self, code: str, message: str, piece: int) -> errors.AosError:
        """The error of model code, at the document place of that number if it is one."""
        spans = self._built.emitted.snippets
        if not 0 < piece <= len(spans):
            error = errors.error_from_code(code, message)
            error.hint = _REPORT_HINT if isinstance(error, errors.EngineDefectError) else error.hint
            return error
        span = spans[piece - 1]
        hint = "Look at this piece of the document"
        diagnostic = Diagnostic(Severity.ERROR, code, message, span, hint)
        return errors.error_from_code(code, f"{span}: {message}", hint=hint, diagnostics=(diagnostic,))

    def _decoded(self, line: bytes, kind: type[A]) -> A:
        try:
            fault = msgspec.json.decode(line, type=_FaultAnswer).fault
            if fault is None:
                return msgspec.json.decode(line, type=kind)
        except UNREADABLE as error:
            raise errors.ModelError(f"the engine's answer makes no sense: {error}", code="AOS213") from error
        raise self.fault(fault.code, fault.text, fault.piece)

    async def _lost(self, kind: type[errors.CodeFaultError], message: str) -> errors.AosError:
        """The error for a child that is gone or has to go; the blame page tells what ran last."""
        piece = self.running_piece
        status = None if kind is errors.EndlessCodeError else await self._status()
        await self.close()
        if status == -signal.SIGKILL:
            how = "frozen by a signal, and was killed" if self._was_frozen else "killed"
            return KilledError(f"the engine was {how}", code="AOS213")
        if status is None:
            return self.fault(kind.code, message, piece)
        if status == -signal.SIGXFSZ:
            message = "the engine's memory is larger than a file may be"
            return errors.ModelError(message, code="AOS213", hint="Raise `ulimit -f`")
        if status == -signal.SIGVTALRM:
            fault = self.fault(OverdueError.code, "this code takes long", piece)
            return OverdueError(fault.message, diagnostics=fault.diagnostics)
        if status == HANG_STATUS and piece:
            return self.fault(errors.EndlessCodeError.code, "this code does not come to an end", piece)
        if status in (REACHING_STATUS, -signal.SIGSYS) and piece:
            return self.fault(kind.code, _REACHING, piece)
        how = _status_text(status)
        if not piece:
            message = f"the engine ended outside of the documents' code ({how})"
            return errors.ModelError(message, code="AOS213", hint=_MEMORY_HINT)
        if status == -signal.SIGSEGV:
            how += ", as for an index out of range or a pointer that leads nowhere"
        return self.fault(kind.code, f"{message} ({how})", piece)

    async def _status(self) -> int | None:
        """Returns the status of a child that has closed its output; None if it lingers."""
        try:
            async with asyncio.timeout(EXIT_DEADLINE_S):
                return await self._child.wait()
        except TimeoutError:
            return None


def _status_text(returncode: int) -> str:
    if -returncode in (signal.SIGFPE, signal.SIGILL, signal.SIGTRAP):
        return f"signal {-returncode}, as for an integer that is divided by zero"
    return f"signal {-returncode}" if returncode < 0 else f"exit status {returncode}"


PRINT_LIMIT_BYTES = 1_000_000
"""An engine child may print this many bytes in its life."""

_CHUNK_BYTES = 65536


async def pass_on(printed: asyncio.StreamReader, out: BinaryIO) -> None:
    """Copies until the end. Past the limit all is read and dropped, so that the model never waits."""
    remaining_bytes = PRINT_LIMIT_BYTES
    while chunk := await printed.read(_CHUNK_BYTES):
        if remaining_bytes <= 0:
            continue
        out.write(chunk[:remaining_bytes])
        remaining_bytes -= len(chunk)
        if remaining_bytes <= 0:
            out.write(b"\naos: model code printed more than 1 MB; the rest is left out\n")
        out.flush()
