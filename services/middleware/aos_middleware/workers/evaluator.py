"""Mapping code from the service's side: a worker process for each mapping, never more than one.

The process is started when it is first needed and again after it ended, whatever ended it: a crash, an
evaluation beyond its deadline, a kill. What mapping code prints is in a log file of its own.
"""

import asyncio
import logging
import os
import re
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from aos_middleware.emission.emit import EmittedMapping
from aos_middleware.workers import frames
from aos_protocol.codec import UNREADABLE
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import LocalSource
from aos_protocol.errors import MappingError, StorageError
from aos_runtime.failpoints import reach
from aos_runtime.processes.children import PIPE, Child, Confinement, Limits, guarded
from aos_runtime.sandbox.places import library_folders, loader_of, python_folders

A = TypeVar("A", frames.Begun, frames.Done, frames.Observed, frames.Taken)

_MARGIN_S = 1.0
"""An answer may take this much longer than the worker's own deadlines before the worker is killed."""

_LARGE_BYTES = 100_000
"""Results and messages that are larger take time to be read, such as pictures."""

_END_S = 1.0
_TRACEBACK_BYTES = 16 * 1024
_FRAME = re.compile(r'^  File "(.*)", line (\d+) in ', re.MULTILINE)

_log = logging.getLogger("aos.middleware")


def worker_confinement() -> Confinement:
    """The sandbox of a worker: it reads Python, with all that is installed there, and AOS."""
    loader = loader_of(os.path.realpath(sys.executable))
    return Confinement(
        profile="worker",
        read=(*library_folders(), *python_folders()),
        execute=(sys.executable, *([loader] if loader else [])),
    )


class EvaluationLimits(msgspec.Struct, frozen=True, kw_only=True):
    """The limits of mapping code: seconds to load its module, seconds for each evaluation, memory,
    imports."""

    load_s: float = 5.0
    evaluation_s: float = 0.5
    address_space_bytes: int = 2 * 1024**3
    file_bytes: int = 16 * 1024**2
    allowed_imports: tuple[str, ...] | None = None


class MappingFault(MappingError):
    """Mapping code failed at a place of its document; `local_variables` are as they were then, as text."""

    def __init__(
        self, message: str, span: Span, *, code: str, hint: str, local_variables: dict[str, str] | None = None
    ) -> None:
        diagnostic = Diagnostic(Severity.ERROR, code, message, span, hint)
        super().__init__(f"{span}: {message}", code=code, hint=hint, diagnostics=(diagnostic,))
        self.local_variables = local_variables or {}


class Evaluator:
    """Runs the code of one mapping, one activation at a time: `begin`, then `take` any often, then `finish`.

    Each raises MappingFault: AOS401 if mapping code raised or ended its process, AOS403 if it did not finish
    in time. After a fault the activation is over; the next `begin` finds a worker again. Whoever runs an
    activation holds `in_use` meanwhile.
    """

    def __init__(self, emitted: EmittedMapping, log_path: Path, limits: EvaluationLimits) -> None:
        self.emitted = emitted
        self.in_use = asyncio.Lock()
        self._log_path = log_path
        self._limits = limits
        self._child: Child | None = None
        self._log_start_bytes = 0

    @property
    def pid(self) -> int | None:
        """The process under which the worker runs, None while there is none."""
        return None if self._child is None else self._child.pid

    async def start(self) -> None:
        """Has a worker with the module loaded; MappingFault if it cannot be loaded."""
        if self._child is not None and self._child.returncode is None:
            return
        await self.close()
        try:
            self._child = await self._start_worker()
        except OSError as error:
            raise StorageError(f"the log {self._log_path}: {error}") from error
        limits = self._limits
        load = frames.Load(
            self.emitted.python,
            self.emitted.file_name,
            limits.load_s,
            limits.evaluation_s,
            limits.allowed_imports,
            self.emitted.truths,
        )
        try:
            await self._ask(load, frames.Done, limits.load_s)
        except MappingFault:
            await self.close()
            raise

    async def begin(
        self, parameters: dict[str, Any], low_level: dict[str, Any] | None = None
    ) -> dict[str, Any]:
        """Starts an activation; the fields of the call."""
        await self.start()
        return (
            await self._ask(
                frames.Begin(parameters, low_level or {}), frames.Begun, self._limits.evaluation_s
            )
        ).fields

    async def take(self, messages: Sequence[tuple[str, dict[str, Any]]]) -> frames.Taken:
        """Hands over topic messages, (topic, fields), in the order in which they came.

        Where one of them makes `stop_when` true, those behind it were not evaluated yet.
        """
        evaluations = 1 + len(self.emitted.mapping.local_variables)
        longest_s = self._limits.evaluation_s * len(messages) * evaluations
        return await self._ask(frames.Take(list(messages)), frames.Taken, longest_s)

    async def finish(
        self, result: dict[str, Any], status: str = "succeeded", error: str = ""
    ) -> frames.Observed:
        """Ends the activation with the call's result: the response, if a rule holds, and local variables.

        With another `status` the skill has failed, and there is no result.
        """
        evaluations = 1 + len(self.emitted.mapping.local_variables)
        return await self._ask(
            frames.Finish(result, status, error), frames.Observed, self._limits.evaluation_s * evaluations
        )

    async def close(self) -> None:
        """Ends the worker. Closing twice does nothing."""
        child, self._child = self._child, None
        if child is not None:
            await child.stop()

    async def _start_worker(self) -> Child:
        limits = self._limits
        command = guarded(
            [sys.executable, "-I", "-m", "aos_middleware.workers.worker"],
            Limits(address_space_bytes=limits.address_space_bytes, file_bytes=limits.file_bytes),
            worker_confinement(),
        )
        reach("middleware.worker.before")
        self._log_path.parent.mkdir(parents=True, exist_ok=True)
        with self._log_path.open("ab") as log:
            self._log_start_bytes = log.tell()
            name = f"mapping of {self.emitted.skill}"
            return await Child.start(command, name=name, cwd="/", stdin=PIPE, stdout=PIPE, stderr=log)

    async def _ask(self, question: frames.Question, expected: type[A], timeout_s: float) -> A:
        child = self._child
        if child is None:
            raise self._fault("AOS401", "the worker has ended", None)
        try:
            frame = frames.pack(question)
        except (ValueError, TypeError, OverflowError) as error:
            raise self._fault("AOS401", f"this cannot be handed to the mapping: {error}", None) from error
        is_answered = False
        try:
            answer = await child.in_time(self._answer(child, frame), timeout_s + _MARGIN_S)
            is_answered = True
        except TimeoutError:
            if child.is_frozen():
                raise self._fault(
                    "AOS401", "the worker was frozen by a signal, and is stopped", None
                ) from None
            message = "the code did not finish in time and was stopped"
            hint = f"Give the mapping of {self.emitted.skill} what it reads, and not {len(frame):,} bytes"
            raise self._fault(
                "AOS403", message, None, hint=hint if len(frame) > _LARGE_BYTES else ""
            ) from None
        except (asyncio.IncompleteReadError, BrokenPipeError, ConnectionResetError):
            limit_s = self._limits.load_s if isinstance(question, frames.Load) else self._limits.evaluation_s
            raise await self._why_it_ended(child, limit_s) from None
        except UNREADABLE as error:
            raise self._fault("AOS401", f"the worker sent no message: {error}", None) from None
        finally:
            if not is_answered:
                # Also when the caller was cancelled: the next answer would be that of this question.
                await self.close()
        if isinstance(answer, frames.Raised):
            raise self._raised(answer)
        if not isinstance(answer, expected):
            await self.close()
            raise self._fault("AOS401", "the worker answered another question", None)
        return answer

    async def _answer(self, child: Child, frame: bytes) -> frames.Answer:
        child.stdin.write(frame)
        await child.stdin.drain()
        size = int.from_bytes(await child.stdout.readexactly(4), "big")
        if size > frames.MAX_FRAME_BYTES:
            raise self._fault("AOS401", "the worker sent no message", None)
        return frames.read_answer(await child.stdout.readexactly(size))

    def _raised(self, answer: frames.Raised) -> MappingFault:
        fields = self.emitted.mapping.activation.fields
        place = next((field.value.span for field in fields if field.name == answer.field), None)
        if answer.line and place is None:
            place = self.emitted.locate(answer.line, answer.column)
        unset = self._unset(answer)
        hint = f"Send it, or give the variable an initial_value in {self.emitted.skill}.am"
        return self._fault(
            "AOS401",
            f"{answer.error}; {unset}" if unset else answer.error,
            place,
            hint=hint if unset else "",
            local_variables=answer.local_variables,
        )

    def _unset(self, answer: frames.Raised) -> str:
        """Most errors in rules that are about None are about a topic that said nothing."""
        if "NoneType" not in answer.error or not answer.error.startswith(("TypeError", "AttributeError")):
            return ""
        without = [each for each in self.emitted.mapping.local_variables if each.name in answer.unset]
        if not without or any(variable.source is not LocalSource.TOPIC for variable in without):
            return ""  # It may be about the result.
        return f"{without[0].name} has no value, for no message came on {without[0].topic}"

    async def _why_it_ended(self, child: Child, limit_s: float) -> MappingFault:
        """The fault behind a worker that ended instead of answering, from what it left in the log."""
        try:
            async with asyncio.timeout(_END_S):
                status = await child.wait()
        except TimeoutError:
            return self._fault("AOS401", "the code closed its worker's connection", None)
        trace = self._left_in_log()
        place = self._place_in(trace)
        if status == -signal.SIGALRM:
            return self._fault("AOS403", f"this took more than {limit_s:g} s and was stopped", place)
        if status == -signal.SIGKILL:
            return self._fault(
                "AOS401", "the worker was killed by signal 9: by somebody, or for memory", place
            )
        how = f"by signal {-status}" if status < 0 else f"with status {status}"
        if status == 1 and not trace and (said := self._written_to_log().strip().rpartition("\n")[2]):
            how += f" and said: {said}"
        return self._fault("AOS401", f"the code ended its process {how}", place)

    def _left_in_log(self) -> str:
        """The traceback with which the process ended, empty if it left none."""
        text = self._written_to_log()
        starts = [text.rfind(head) for head in ("Current thread 0x", "Fatal Python error:")]
        return text[max(starts) :] if max(starts) >= 0 else ""

    def _written_to_log(self) -> str:
        """The end of what this worker has written to the log."""
        with self._log_path.open("rb") as log:
            end = log.seek(0, 2)
            log.seek(max(self._log_start_bytes, end - _TRACEBACK_BYTES))
            return log.read().decode(errors="replace")

    def _place_in(self, trace: str) -> Span | None:
        for file_name, line in _FRAME.findall(trace):
            if file_name == self.emitted.file_name:
                return self.emitted.locate(int(line))
        return None

    def _fault(
        self,
        code: str,
        message: str,
        place: Span | None,
        *,
        hint: str = "",
        local_variables: dict[str, str] | None = None,
    ) -> MappingFault:
        _log.warning("mapping of %s: %s at %s", self.emitted.skill, message, place or "an unknown place")
        return MappingFault(
            message,
            place or self.emitted.mapping.span,
            code=code,
            hint=hint or f"Mend the abstraction mapping of {self.emitted.skill}, or what its adapter gives",
            local_variables=local_variables,
        )
