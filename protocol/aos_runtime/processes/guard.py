r"""A small process around a command that must leave nothing behind: compilers, engines, mapping workers.

    python -m aos_runtime.processes.guard [--address-space-bytes N] [--cpu-s N] [--file-bytes N] \
        [--niceness N] [--grace-s S] [--left-behind-s S] [--profile NAME [--read PATH]... \
        [--execute PATH]... [--write PATH]... [--trust YES]] -- command...

The command runs in a process group of its own, under the limits, on the guard's own stdin, stdout and
stderr. When it ends, when the guard is told to stop (SIGTERM, SIGINT, SIGHUP), or when the guard's parent
ends, every descendant of the guard is ended, those that left the group too: SIGTERM, and after the grace
SIGKILL, which the error output tells; after SIGQUIT, SIGKILL at once. Where the command ended by itself, the
time `left_behind_s` counts in place of the grace. The guard then ends the way the command did, by the same
signal or with the same status; with 127 if the command cannot be started.

With a profile the command runs in a sandbox, and may use the files below the paths named and no others; see
`sandbox.confine`. Where the kernel cannot do that, it does not run, unless its documents are trusted.

What can start processes runs behind a keeper, a child of the guard that does this work, in a session of its
own: if the guard is killed with SIGKILL, the keeper ends the command and all that it has started. Engines and
workers start none, and die with their guard. Guard and keeper hear of their parent's end though SIGSTOP has
stopped them: the kernel tells it by SIGCONT.
Write command lines with `children.guarded`. The module imports little and no site packages: it starts in
about 17 ms.
"""

from __future__ import annotations

import errno
import os
import resource
import sys
import time

from aos_runtime.processes.parent import adopt_orphans, die_with_parent, request_death_signal
from aos_runtime.sandbox.confine import ACCESS, Sandbox, become_confined
from aos_runtime.sandbox.profiles import ALONE

TYPE_CHECKING = False  # typing itself takes as long to import as everything else here.
if TYPE_CHECKING:
    import signal
    from typing import NoReturn
else:
    import _signal as signal  # `signal` makes enums of the numbers, for a third of the guard's start

_STOP_SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
_PARENT_ENDED = signal.SIGCONT
"""The kernel sends it at the parent's end: of all signals that a process can wait for, this one alone wakes a
stopped process. Others send it, too."""
NOT_STARTED = 127
"""The status of a guard whose command cannot be started."""
_GRACE_S = 0.5

_AT_ONCE = signal.SIGQUIT
_NICENESS = "--niceness"
_LIMITS = {
    "--address-space-bytes": resource.RLIMIT_AS,
    "--cpu-s": resource.RLIMIT_CPU,
    "--file-bytes": resource.RLIMIT_FSIZE,
}


def main(arguments: list[str]) -> NoReturn:
    """Runs the command named in the arguments and ends as it ends."""
    grace_s, left_behind_s, niceness, limits, sandbox, command = _parse(arguments)
    signals = _Signals(os.getppid(), signal.SIGTERM)
    die_with_parent(_PARENT_ENDED)
    adopt_orphans()
    if sandbox.profile not in ALONE:
        signals = _leave_to_keeper(signals, grace_s)
    guard_pid = os.getpid()
    pid = os.fork()
    if pid == 0:
        _become(command, niceness, limits, sandbox, guard_pid)
    status, was_asked = _wait(pid, signals, grace_s)
    _end_descendants(signals, grace_s if was_asked or left_behind_s is None else left_behind_s)
    _end_like(status)


class _Signals:
    """The signals that a guard or a keeper waits for. The end of its parent means the same as `at_end`."""

    def __init__(self, parent_pid: int, at_end: signal.Signals) -> None:
        signal.pthread_sigmask(signal.SIG_BLOCK, {*_STOP_SIGNALS, _AT_ONCE, _PARENT_ENDED, signal.SIGCHLD})
        self._parent_pid = parent_pid
        self._at_end = at_end

    def next(self) -> int:
        """Waits for one, and returns it; 0 where it means nothing."""
        received = signal.sigwait({*_STOP_SIGNALS, _AT_ONCE, _PARENT_ENDED, signal.SIGCHLD})
        return self._meaning(received)

    def is_told_at_once(self, timeout_s: float) -> bool:
        """Returns whether all has to end at once, as soon as that is told or a child has ended."""
        received = signal.sigtimedwait({_AT_ONCE, _PARENT_ENDED, signal.SIGCHLD}, max(timeout_s, 0.0))
        return received is not None and self._meaning(received.si_signo) == _AT_ONCE

    def _meaning(self, received: int) -> int:
        if received != _PARENT_ENDED:
            return received
        return self._at_end if os.getppid() != self._parent_pid else 0


def _leave_to_keeper(signals: _Signals, grace_s: float) -> _Signals:
    """Returns in the keeper, its signals. The guard passes its own on to it, and ends as it ends."""
    guard_pid = os.getpid()
    keeper = os.fork()
    if keeper == 0:
        os.setsid()
        request_death_signal(_PARENT_ENDED, guard_pid)
        adopt_orphans()
        return _Signals(guard_pid, _AT_ONCE)
    while True:
        ended, status = os.waitpid(keeper, os.WNOHANG)
        if ended:
            _end_descendants(signals, grace_s)
            _end_like(status)
        received = signals.next()
        if received not in (0, signal.SIGCHLD):
            os.kill(keeper, received)
            os.kill(keeper, signal.SIGCONT)  # A frozen one hears nothing.


def _parse(arguments: list[str]) -> tuple[float, float | None, int, dict[int, int], Sandbox, list[str]]:
    """The grace, that of what is left behind, the niceness, the limits by kind, the sandbox, the command."""
    split = arguments.index("--") if "--" in arguments else len(arguments)
    options, command = arguments[:split], arguments[split + 1 :]
    if len(options) % 2 or not command:
        _fail("usage: guard [--option value]... -- command...")
    grace_s = _GRACE_S
    left_behind_s: float | None = None
    niceness = 0
    limits: dict[int, int] = {}
    sandbox = Sandbox()
    for name, text in zip(options[::2], options[1::2], strict=True):
        if name == "--grace-s":
            grace_s = float(text)
        elif name == "--left-behind-s":
            left_behind_s = float(text)
        elif name == _NICENESS:
            niceness = int(text)
        elif name in _LIMITS:
            limits[_LIMITS[name]] = int(text)
        elif name == "--profile":
            sandbox.profile = text
        elif name == "--trust":
            sandbox.is_trusted = True
        elif name in ACCESS:
            sandbox.files.append((text, ACCESS[name]))
        else:
            _fail(f"unknown option {name}")
    return grace_s, left_behind_s, niceness, limits, sandbox, command


def _become(
    command: list[str], niceness: int, limits: dict[int, int], sandbox: Sandbox, guard_pid: int
) -> NoReturn:
    """Turns the child into the command: own process group, niceness, limits, sandbox, then the command in
    place of this program."""
    try:
        os.setpgid(0, 0)
        _give_way(niceness)
        request_death_signal(signal.SIGKILL, guard_pid)
        for kind, value in {resource.RLIMIT_CORE: 0, **limits}.items():
            _limit(kind, value)
        # What Python ignores, the command would inherit as ignored.
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, ())
        if sandbox.profile:
            become_confined(command, sandbox)
        os.execvp(command[0], command)
    except OSError as error:
        reason = str(error.strerror)
        if error.errno == errno.ENOEXEC:
            reason += ". A script needs a first line that names its interpreter, as #!/bin/sh"
        _fail(f"cannot start {command[0]}: {reason}")


def _give_way(niceness: int) -> None:
    """Makes this process nicer, and its session: where Linux shares processors among sessions first
    (`sched_autogroup_enabled`), the niceness of a process counts within its own only."""
    if niceness == 0:
        return
    os.nice(niceness)
    try:
        session = os.open("/proc/self/autogroup", os.O_WRONLY)
        os.write(session, str(niceness).encode())
        os.close(session)
    except OSError:
        pass  # a kernel without them, or one that was told too often


def _limit(kind: int, value: int) -> None:
    _, hard = resource.getrlimit(kind)
    if hard != resource.RLIM_INFINITY:
        value = min(value, hard)
    resource.setrlimit(kind, (value, value))


def _wait(pid: int, signals: _Signals, grace_s: float) -> tuple[int, bool]:
    """The command's wait status, and whether it was asked to end; being told to stop stops it first."""
    kill_at_s: float | None = None
    while True:
        ended, status = os.waitpid(pid, os.WNOHANG)
        if ended:
            return status, kill_at_s is not None
        if kill_at_s is None:
            received = signals.next()
            if received == _AT_ONCE:
                kill_at_s = 0.0
                os.kill(os.getpid(), _AT_ONCE)  # What the command leaves behind ends as quickly.
            elif received in _STOP_SIGNALS:
                _signal_group(pid, signal.SIGTERM)
                kill_at_s = time.monotonic() + grace_s
        elif time.monotonic() >= kill_at_s:
            _signal_group(pid, signal.SIGKILL)
            return os.waitpid(pid, 0)[1], True
        elif signals.is_told_at_once(kill_at_s - time.monotonic()):
            kill_at_s = 0.0
            os.kill(os.getpid(), _AT_ONCE)


def _end_descendants(signals: _Signals, grace_s: float) -> None:
    """Ends what the command left behind; it has become this process's own children."""
    kill_at_s = time.monotonic() + grace_s
    told: set[int] = set()
    while children := _children():
        is_late = time.monotonic() >= kill_at_s
        for child in children:
            os.kill(child, signal.SIGKILL if is_late else signal.SIGTERM)
            if is_late and kill_at_s and child not in told:
                told.add(child)
                name = _told_by_kernel(f"{child}/comm")
                _tell(f"{child} ({name}) went on after SIGTERM, and is killed")
        if signals.is_told_at_once(0.05):
            kill_at_s = 0.0
        _reap()


def _children() -> list[int]:
    _reap()
    return [int(pid) for pid in _told_by_kernel(f"self/task/{os.getpid()}/children").split()]


def _told_by_kernel(file: str) -> str:
    with os.fdopen(os.open(f"/proc/{file}", os.O_RDONLY), errors="replace") as told:
        return told.read().strip()


def _reap() -> None:
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass


def _signal_group(pid: int, number: signal.Signals) -> None:
    for target, send in ((pid, os.killpg), (pid, os.kill)):
        # Before the child has made its group only the second reaches it.
        try:
            send(target, number)
        except ProcessLookupError:
            continue


def _end_like(status: int) -> NoReturn:
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if number not in (signal.SIGKILL, signal.SIGSTOP):
            signal.signal(number, signal.SIG_DFL)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {number})
        os.kill(os.getpid(), number)
        os._exit(128 + number)
    os._exit(os.waitstatus_to_exitcode(status))


def _fail(text: str) -> NoReturn:
    _tell(text)
    os._exit(NOT_STARTED)


def _tell(text: str) -> None:
    try:
        os.write(2, f"guard: {text}\n".encode())
    except OSError:
        return  # a log on a full disk, or one that nobody reads


if __name__ == "__main__":
    main(sys.argv[1:])
