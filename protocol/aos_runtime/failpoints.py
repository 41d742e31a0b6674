"""Failpoints: named places at which a test lets a process fail, once.

`AOS_FAILPOINT=NAME:ACTION` or `NAME:ACTION:TIME` in the environment arms one; the process fails when it comes
there for that time, the first without a number. Actions: `kill` (SIGKILL), `exit` (an exit without any
cleaning up), `freeze` (SIGSTOP), and `full` or `readonly`: the disk is full, or read-only, at this write and
for the process from then on.
`AOS_FAILPOINT_DONE` may name a file that is made when the process fails; where it is there, nothing fails
any more, so that a process that is started again goes on.

Where nothing is armed a place costs the look at one variable. Only `Journal` reaches places with names of its
own making: `FILE.KIND.before` and `FILE.KIND.after`.
"""

import errno
import os
import signal

EXIT_STATUS = 70

FAILPOINTS = {
    "up.start.before": "`aos-up` is about to start a process",
    "up.start.after": "`aos-up` has started a process",
    "up.record.before": "`aos-up` is about to write `run.json`",
    "up.summary.before": "`aos-up` is about to write `summary.json`",
    "up.summary.after": "`aos-up` has written `summary.json`",
    "solver.engine.before": "the solver is about to start an engine",
    "solver.engine.after": "the solver has started an engine",
    "journal.begun.before": "the solver is about to write that it begins",
    "journal.begun.after": "the solver has written that it begins",
    "journal.mission.before": "the solver, or `aos-up` at the end, is about to write the mission's phase",
    "journal.mission.after": "the solver, or `aos-up` at the end, has written the mission's phase",
    "journal.decision.before": "the solver is about to write a decision, or what was observed",
    "journal.decision.after": "the solver has written a decision, or what was observed",
    "journal.intended.before": "the solver is about to write what it intends",
    "journal.intended.after": "the solver has written what it intends, and has not asked for it",
    "journal.outcome.before": "the solver has an outcome, and is about to write it",
    "journal.outcome.after": "the solver has written an outcome",
    "middleware.worker.before": "the middleware is about to start a worker",
    "middleware.started.before": "the middleware is about to write that an activation begins",
    "middleware.started.after": "the middleware has written that an activation begins",
    "middleware.call.before": "the middleware is about to call an adapter",
    "middleware.call.after": "the middleware has an adapter's answer",
    "middleware.ended.before": "the middleware is about to write an outcome",
    "middleware.ended.after": "the middleware has written an outcome, and has not answered",
    "adapter.started.before": "an adapter is about to write that a call begins",
    "adapter.started.after": "an adapter has written that a call begins, and nothing moves yet",
    "adapter.ended.before": "the robot has moved, and the adapter is about to write how it ended",
    "adapter.ended.after": "an adapter has written how a call ended, and has not answered",
}
"""Each place with what the process is about."""

_NO_WRITES = {"up.start.before", "solver.engine.before", "middleware.worker.before", "middleware.call.before"}

_REFUSALS = {"full": errno.ENOSPC, "readonly": errno.EROFS}

_armed = os.environ.get("AOS_FAILPOINT", "")
_done = os.environ.get("AOS_FAILPOINT_DONE", "")
_times = 0

is_armed = bool(_armed)
"""True where the environment arms a failpoint."""


def reach(name: str) -> None:
    """Fails where this place is armed; OSError ENOSPC or EROFS where its disk is full or read-only."""
    if is_armed:
        _reach(name)


def _reach(name: str) -> None:
    global _times
    place, action, time = (*_armed.split(":"), "1")[:3]
    _times += place == name
    if action in _REFUSALS and _times >= int(time) and name.endswith(".before") and name not in _NO_WRITES:
        _is_first()
        raise OSError(_REFUSALS[action], os.strerror(_REFUSALS[action]))
    if place != name or _times != int(time) or not _is_first():
        return
    if action == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    elif action == "freeze":
        os.kill(os.getpid(), signal.SIGSTOP)
    elif action == "exit":
        os._exit(EXIT_STATUS)


def _is_first() -> bool:
    """Says whether no process has failed before; from now on one has."""
    if not _done:
        return True
    try:
        os.close(os.open(_done, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
    except FileExistsError:
        return False
    return True
