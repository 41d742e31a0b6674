"""C++ text that makes a system call by itself, whatever the library declares."""

from __future__ import annotations

import os

from aos_runtime.sandbox.system_calls import numbers_of

__all__ = ["system_call"]

_X86_64 = (
    'asm volatile("syscall" : "=a"(REACHED) : "a"(NUMBERL), "D"((long)(A)), "S"((long)(B)), "d"((long)(C))'
    ' : "rcx", "r11", "memory", "r10", "r8");'
)
_AARCH64 = (
    'asm volatile("mov x8, %1\\n mov x0, %2\\n mov x1, %3\\n mov x2, %4\\n svc 0\\n mov %0, x0"'
    ' : "=r"(REACHED)'
    ' : "r"(NUMBERL), "r"((long)(A)), "r"((long)(B)), "r"((long)(C)) : "x0", "x1", "x2", "x8", "memory");'
)


def system_call(name: str, *arguments: str | int, result: str = "reached") -> str:
    """Statements that declare `result` and call the system with up to three arguments."""
    machine = os.uname().machine
    first, second, third = (str(word) for word in (*arguments, 0, 0, 0)[:3])
    text = _X86_64 if machine == "x86_64" else _AARCH64
    text = text.replace("NUMBER", str(numbers_of(machine)[name])).replace("REACHED", result)
    text = text.replace("(A)", f"({first})").replace("(B)", f"({second})").replace("(C)", f"({third})")
    return f"long {result} = 0; {text}"
