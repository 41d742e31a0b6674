"""Filters of system calls: written as rules, assembled for the kernel, put on this process.

A rule stands for one call. It has conditions on the arguments, of which one must hold, and says what follows
if none does. The program compares the call's number with each rule in turn. Sizes and numbers are those of
linux/seccomp.h and linux/filter.h.
"""

from __future__ import annotations

import ctypes
import os
import struct

from aos_runtime.sandbox.system_calls import ARCHITECTURES, numbers_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

KILL, TRAP, ALLOW = 0x80000000, 0x00030000, 0x7FFF0000
_FAIL = 0x00050000

Condition = tuple[int, int, int]
"""An argument's place, and what is left of it by a mask. A mask of 32 bits leaves the upper half alone."""

_LOAD, _AND, _IF_EQUAL, _IF_AT_LEAST, _RETURN = 0x20, 0x54, 0x15, 0x35, 0x06
_NUMBER, _ARCHITECTURE, _ARGUMENTS = 0, 4, 16
_OF_X32 = 0x40000000
"""Calls of the ABI with 32-bit pointers have this bit. No architecture has so many calls."""

_SET_MODE_FILTER, _LEAVE_SPECULATION = 1, 1 << 2
_CALL_OF = {"x86_64": 317, "aarch64": 277}
_NO_NEW_PRIVILEGES = 38


class Rule:
    """A rule for the call `name`: what follows where one of the alternatives holds, and where none does.

    An alternative holds if all of its conditions do; without alternatives the rule always holds.
    """

    def __init__(
        self,
        name: str,
        action: int = ALLOW,
        *,
        alternatives: Iterable[Iterable[Condition]] = ((),),
        otherwise: int = KILL,
    ) -> None:
        self.name = name
        self.action = action
        self.alternatives = alternatives
        self.otherwise = otherwise


def fail_with(error: int) -> int:
    """The action by which a call fails with an error number."""
    return _FAIL | error


def assemble(
    rules: Iterable[Rule], machine: str, *, default: int, newest: int = 1 << 30, newer: int = KILL
) -> bytes:
    """The program for a machine. Of two rules for a call the first counts.

    Calls that no rule names have the action `default`, those above the number `newest` the action `newer`.
    Calls of another architecture end the process, and so do those with 32-bit pointers.
    """
    numbers = numbers_of(machine)
    program = [
        _step(_LOAD, _ARCHITECTURE),
        _step(_IF_EQUAL, ARCHITECTURES[machine], 1, 0),
        _step(_RETURN, KILL),
        _step(_LOAD, _NUMBER),
        _step(_IF_AT_LEAST, _OF_X32, 0, 1),
        _step(_RETURN, KILL),
    ]
    for rule in rules:
        if rule.name in numbers:
            body = _body(rule)
            program += [_step(_IF_EQUAL, numbers[rule.name], 0, len(body)), *body]
    program += [_step(_IF_AT_LEAST, newest + 1, 0, 1), _step(_RETURN, newer), _step(_RETURN, default)]
    return b"".join(program)


def give_up_new_privileges() -> None:
    """Has nothing that this process executes get more rights than it has, so that it may confine itself."""
    zero = ctypes.c_ulong(0)
    if ctypes.CDLL(None, use_errno=True).prctl(_NO_NEW_PRIVILEGES, ctypes.c_ulong(1), zero, zero, zero) != 0:
        raise _last_error()


def put_on(program: bytes, machine: str) -> None:
    """Filters the calls of this process, and of all that it starts, from now on; OSError if it cannot be.

    The process has given up new privileges before.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    text = ctypes.create_string_buffer(program, len(program))
    head = struct.pack("@HP", len(program) // 8, ctypes.addressof(text))
    number = ctypes.c_long(_CALL_OF[machine])
    for flags in (_LEAVE_SPECULATION, 0):
        # Without the flag some kernels slow down what this process computes. Old ones do not know it.
        if libc.syscall(number, ctypes.c_long(_SET_MODE_FILTER), ctypes.c_long(flags), head) == 0:
            return
    raise _last_error()


def why_missing(machine: str) -> str:
    """The reason why no filter can be put on processes of this machine; empty if one can."""
    if machine not in ARCHITECTURES or struct.calcsize("P") != 8:
        return f"there is no list of system calls for {machine} with {8 * struct.calcsize('P')} bits"
    libc = ctypes.CDLL(None, use_errno=True)
    wanted = struct.pack("=I", TRAP)
    if libc.syscall(ctypes.c_long(_CALL_OF[machine]), ctypes.c_long(2), ctypes.c_long(0), wanted) != 0:
        return f"the kernel does not filter system calls here: {_last_error().strerror}"
    return ""


def _body(rule: Rule) -> list[bytes]:
    """The steps that follow when the number is the rule's."""
    body: list[bytes] = []
    for alternative in rule.alternatives:
        checks = [_checks(condition) for condition in alternative]
        after = sum(len(steps) for steps in checks)
        for steps in checks:
            for code, value in steps:
                after -= 1
                # A comparison that fails goes on behind the alternative's own return.
                body.append(_step(code, value, 0, after + 1 if code == _IF_EQUAL else 0))
        body.append(_step(_RETURN, rule.action))
    return [*body, _step(_RETURN, rule.otherwise)] if all(rule.alternatives) else body


def _checks(condition: Condition) -> list[tuple[int, int]]:
    """The steps that compare an argument: of each half that the mask leaves, little end first."""
    place, mask, value = condition
    steps = []
    for half in range(2):
        part = mask >> 32 * half & 0xFFFFFFFF
        if part:
            steps += [
                (_LOAD, _ARGUMENTS + 8 * place + 4 * half),
                (_AND, part),
                (_IF_EQUAL, value >> 32 * half & 0xFFFFFFFF),
            ]
    return steps


def _step(code: int, value: int, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("=HBBI", code, if_true, if_false, value)


def _last_error() -> OSError:
    number = ctypes.get_errno()
    return OSError(number, os.strerror(number))
