"""The consequence of a program that ends by itself: started again, given up, ignored, or the run ends.

A run ends with the reason: the fault that the process left, what ssh says, or its status and last lines.
"""

import asyncio
import signal
from collections import deque
from collections.abc import Iterable

from aos_deploy.processes.program import Program
from aos_deploy.processes.remote import is_lost, why_it_failed
from aos_deploy.runs.directory import RunDirectory
from aos_protocol.errors import AosError, DeployError, StorageError, error_from_code
from aos_protocol.messages import Fault
from aos_runtime.processes.children import Child
from aos_runtime.processes.guard import NOT_STARTED
from aos_runtime.processes.lifecycle import STORAGE_STATUS

STARTED_AGAIN, GIVEN_UP, IGNORED, THE_RUN_ENDS = "it is started again", "given up", "ignored", "the run ends"
"""The consequences of a process that ends by itself."""

_MISTAKES = (2, 126, NOT_STARTED)
"""Statuses that programs and shells have for a command line that is wrong, which stays wrong."""
_HOPELESS = ("AOS1", "AOS7", "AOS8")
"""The beginnings of the codes of faults that the next start would find again."""


class RunningProgram:
    """A program's process. `starts` counts how often it was started, `ready` is set once it was ready."""

    child: Child

    def __init__(self, program: Program) -> None:
        self.program = program
        self.restarts = Restarts(is_adapter=program.is_adapter)
        self.started_s = 0.0
        self.ready = asyncio.Event()
        self.is_ready = False
        self.seeking: asyncio.Task[None] | None = None
        self.silence: asyncio.Task[None] | None = None
        self.silent_since_s = 0.0

    def end_at_once(self) -> None:
        """Ends the process, and what it has started, without asking."""
        (self.child.end_at_once if self.program.is_guarded else self.child.kill)()


def consequence(
    running: RunningProgram, status: int, others: Iterable[RunningProgram], run: RunDirectory, now_s: float
) -> str:
    """Returns the consequence of a program that ended by itself with a status, beside these others."""
    program, was_ready = running.program, running.ready.is_set()
    if program.on_exit == "ignore" and was_ready:
        return IGNORED
    # Before it was ready, only what the next start may find otherwise is tried again.
    is_mistake = status in _MISTAKES or run.fault(program.name) is not None
    may_succeed = (
        not _is_hopeless(program, status, run) if was_ready else bool(program.command) and not is_mistake
    )
    # A link that is cut again and again is no fault of the program: how long to wait, the mission says.
    is_cut = was_ready and is_lost(program, status)
    has_starts = is_cut or running.restarts.are_left(now_s)
    if may_succeed and program.is_restarted and has_starts:
        return STARTED_AGAIN
    # What an adapter served is unavailable; the mission goes on with the rest.
    goes_on = was_ready and program.is_adapter and any(map(_is_living_adapter, others))
    return GIVEN_UP if goes_on else THE_RUN_ENDS


def fatal_end(running: RunningProgram, status: int, run: RunDirectory) -> AosError:
    """The error that a run ends with because this program has ended."""
    error = end_of(running.program, run, status, was_ready=running.ready.is_set())
    if running.restarts.count >= running.restarts.most:
        error.message += f", and was started {running.restarts.most} times within {WITHIN_S:g} s"
    return error


def _is_hopeless(program: Program, status: int, run: RunDirectory) -> bool:
    if program.is_adapter:
        return False
    fault = run.fault(program.name)
    # On a full disk there may be no space for the fault.
    return fault.code.startswith(_HOPELESS) if fault is not None else status == STORAGE_STATUS


def _is_living_adapter(running: RunningProgram) -> bool:
    return running.program.is_adapter and running.child.returncode is None


STARTS = 5
"""A process is started so many times within WITHIN_S at most."""

STARTS_OF_ADAPTER = 10
"""An adapter that was ready after its last start is started so many times: three skills that end it in each
call are set aside before."""

WITHIN_S = 60.0

_FIRST_S = 0.2
_LONGEST_S = 5.0


class Restarts:
    """The starts of one process, by a monotonic clock in seconds."""

    def __init__(self, *, is_adapter: bool = False) -> None:
        self.count = 0
        self._is_adapter = is_adapter
        self._in_vain = 0
        self._recent: deque[float] = deque(maxlen=STARTS_OF_ADAPTER)

    def start(self, now_s: float) -> None:
        """Takes note of a start."""
        self.count += 1
        self._in_vain += 1
        self._recent.append(now_s)

    def succeed(self) -> None:
        """Takes note that the process is ready."""
        self._in_vain = 0

    @property
    def most(self) -> int:
        """The number of starts within WITHIN_S after which the process is not started again."""
        return STARTS_OF_ADAPTER if self._is_adapter and not self._in_vain else STARTS

    def are_left(self, now_s: float) -> bool:
        """Says whether the process may be started again."""
        return self._recent_starts(now_s) < self.most

    def delay_s(self, now_s: float, *, is_cut: bool = False) -> float:
        """Returns how long the next start waits: 0.2 s after the first, then twice as long each time.

        Where a connection was cut, those starts alone count that were in vain, and without one it is made
        again at once.
        """
        if is_cut and not self._in_vain:
            return 0.0
        recent = self._in_vain if is_cut else self._recent_starts(now_s)
        return min(_FIRST_S * 2.0 ** max(recent - 1, 0), _LONGEST_S)

    def _recent_starts(self, now_s: float) -> int:
        return sum(now_s - at_s <= WITHIN_S for at_s in self._recent)


def end_of(program: Program, run: RunDirectory, status: int, *, was_ready: bool) -> AosError:
    """The error for a process that ended by itself."""
    name = program.name
    fault = run.fault(name)
    if fault is not None:
        return error_from_code(
            fault.code, f"{name}: {fault.message}", hint=fault.hint, diagnostics=fault.diagnostics
        )
    if program.host and (failed := why_it_failed(name, program.host, status, run.last_log_lines(name))):
        return failed
    if status == STORAGE_STATUS and not program.command:
        text = f"{name} could not write or read its files"
        hint = f"See that the disk of the run has space and can be written. {look_at_log(run, name)}"
        return StorageError(text, hint=hint)
    code = "AOS804" if was_ready else "AOS802"
    text, hint = f"{name} ended unexpectedly: {status_text(status)}", look_at_log(run, name)
    if program.ready is not None and program.ready.exit is not None:
        text = f"{name} ended with {status_text(status)}, and is to end with {program.ready.exit}"
    elif program.is_own and status == 0:
        hint = f"What goes into the background has ended: keep it in the foreground. {hint}"
    return DeployError(text, code=code, hint=hint)


def told_end(program: Program, run: RunDirectory, status: int) -> str:
    """The status of a process that ended by itself, with the fault it left or what ssh says."""
    name = program.name
    said: Fault | AosError | None = run.fault(name)
    if said is None and program.host:
        said = why_it_failed(name, program.host, status, run.last_log_lines(name))
    return status_text(status) if said is None else f"{status_text(status)}, {said.message}"


def look_at_log(run: RunDirectory, name: str) -> str:
    """Returns the place of a service's log, and its last lines."""
    lines = run.last_log_lines(name)
    where = f"Its log is {run.log(name)}"
    return "\n    ".join([f"{where}; it ends:", *lines]) if lines else where


def status_text(status: int) -> str:
    """An exit status, or the signal that ended a process."""
    if status >= 0:
        return f"exit status {status}"
    return f"killed by {signal.Signals(-status).name}"
