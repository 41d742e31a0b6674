"""Ending with the parent: no process of AOS outlives the one that started it, whatever kills that one.

Linux delivers a signal to a process when the *thread* that started it ends (`PR_SET_PDEATHSIG`). The child
asks for it itself, first thing: asking from the parent would need `preexec_fn`, which can deadlock beside
Zenoh's threads. Who starts children does so from its main thread and names itself in `PARENT_VARIABLE`, so
that a child whose parent died before the request knows.
"""

from __future__ import annotations

import ctypes
import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    import signal
else:
    import _signal as signal  # as in guard.py, which has to start quickly

PARENT_VARIABLE = "AOS_PARENT_PID"

_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36


def die_with_parent(death_signal: signal.Signals = signal.SIGKILL) -> None:
    """Has the kernel send `death_signal` when the parent ends; ends now if it already has.

    Does nothing in a process that was not started by AOS, from a shell for example. The variable is taken out
    of the environment, so that it does not reach this process's own children.
    """
    parent = os.environ.pop(PARENT_VARIABLE, "")
    if not parent:
        return
    request_death_signal(death_signal, int(parent))


def request_death_signal(death_signal: signal.Signals, parent_pid: int) -> None:
    """Does what `die_with_parent` does, for a child that knows its parent."""
    _prctl(_PR_SET_PDEATHSIG, death_signal)
    if os.getppid() != parent_pid:
        os._exit(128 + death_signal)


def adopt_orphans() -> None:
    """Makes this process the parent of every descendant whose own parent ends, instead of process 1."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def _prctl(option: int, value: int) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(option, value, 0, 0, 0) != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
