"""The reason why a process of the system ended: the fault it left, what ssh says, or its status and last
lines."""

import signal

from aos_deploy.processes.program import Program
from aos_deploy.processes.remote import why_it_failed
from aos_deploy.runs.directory import RunDirectory
from aos_protocol.errors import AosError, DeployError, StorageError, error_from_code
from aos_protocol.messages import Fault
from aos_runtime.processes.lifecycle import STORAGE_STATUS


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
