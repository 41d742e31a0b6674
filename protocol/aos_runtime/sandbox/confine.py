"""The last steps of a process on its way into the sandbox: files, system calls, and the command in its place.

No helper program and no privilege is needed; root and users without namespaces are confined alike. What the
command starts, if its profile lets it start anything, is confined as well, and nothing takes that back.
"""

from __future__ import annotations

import ctypes
import os

from aos_runtime.sandbox.landlock import EXECUTE, READ, WRITE, restrict_files, version
from aos_runtime.sandbox.profiles import ENVIRONMENT, program_of
from aos_runtime.sandbox.seccomp import give_up_new_privileges, put_on, why_missing

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

ACCESS = {"--read": READ, "--execute": EXECUTE, "--write": WRITE}

_DEVICES = (("/dev/null", WRITE), ("/dev/zero", READ), ("/dev/urandom", READ), ("/dev/random", READ))
_FIRST_TO_END = "1000"


class Sandbox:
    """The profile of a command, or none, and the rights it has below each path. Where its documents are
    trusted, it runs also with a kernel that can confine it only in part."""

    def __init__(self) -> None:
        self.profile = ""
        self.files: list[tuple[str, int]] = []
        self.is_trusted = False


def become_confined(command: list[str], sandbox: Sandbox) -> NoReturn:
    """Puts the command in the place of this process, in the sandbox; OSError if that cannot be."""
    kept = ENVIRONMENT[sandbox.profile]
    environment = [f"{name}={os.environ[name]}" for name in kept if name in os.environ]
    program = _found(command[0])
    _offer_to_end_first()
    give_up_new_privileges()
    _restrict_files(sandbox)
    path = ctypes.c_char_p(os.fsencode(program))
    arguments = _array(command)
    variables = _array(environment)
    machine = os.uname().machine
    addresses = (_address(path), ctypes.addressof(arguments), ctypes.addressof(variables))
    libc = ctypes.CDLL(None, use_errno=True)
    if not (sandbox.is_trusted and why_missing(machine)):
        put_on(program_of(sandbox.profile, machine, os.getpid(), addresses), machine)
    libc.execve(path, arguments, variables)
    number = ctypes.get_errno()
    raise OSError(number, os.strerror(number))


def _restrict_files(sandbox: Sandbox) -> None:
    try:
        known = version()
    except OSError:
        if sandbox.is_trusted:
            return
        raise
    restrict_files([*_DEVICES, *sandbox.files], known)


def _offer_to_end_first() -> None:
    """Has the kernel end this process before any that controls a robot, where memory runs out."""
    try:
        score = os.open("/proc/self/oom_score_adj", os.O_WRONLY)
        os.write(score, _FIRST_TO_END.encode())
        os.close(score)
    except OSError:
        pass  # nobody offers less than a container's own offer


def _found(program: str) -> str:
    """The path of a program, as a shell finds it."""
    if "/" in program:
        return program
    for folder in os.get_exec_path():
        path = f"{folder}/{program}"
        if os.access(path, os.X_OK):
            return path
    return program


def _array(texts: list[str]) -> ctypes.Array[ctypes.c_char_p]:
    return (ctypes.c_char_p * (len(texts) + 1))(*(os.fsencode(text) for text in texts), None)


def _address(text: ctypes.c_char_p) -> int:
    return ctypes.cast(text, ctypes.c_void_p).value or 0
