"""The sandbox's profiles: what a compiler, an engine and a worker may do, in one table.

Engine and worker run code of documents: they may call what computing takes. Compilers run none of it: they
may call what the table does not refuse. Which files they may use is said where they are started.
"""

import errno
import os

from aos_runtime.sandbox import system_calls as calls
from aos_runtime.sandbox.seccomp import ALLOW, TRAP, Rule, assemble, fail_with

_REFUSED = fail_with(errno.EPERM)
_ABSENT = fail_with(errno.ENOSYS)

_32_BITS = 0xFFFFFFFF
_64_BITS = 0xFFFFFFFFFFFFFFFF

ALONE = ("engine", "worker")
"""The profiles of processes that start no others."""

_LANGUAGE = ("LC_ALL", "LC_CTYPE", "LANG", "TZ", "LD_LIBRARY_PATH")
_TOOLS = ("PATH", "TMPDIR", "CPATH", "C_INCLUDE_PATH", "CPLUS_INCLUDE_PATH", "LIBRARY_PATH", "COMPILER_PATH")
_OWN_PLACES = (
    "GCC_EXEC_PREFIX",
    "ZIG_GLOBAL_CACHE_DIR",
    "ZIG_LOCAL_CACHE_DIR",
    "ZIG_LIB_DIR",
    "CCACHE_DISABLE",
)
ENVIRONMENT = {
    "compiler": (*_LANGUAGE, *_TOOLS, *_OWN_PLACES),
    "engine": (*_LANGUAGE, "MALLOC_ARENA_MAX", "AOS_WITHOUT"),
    "worker": (*_LANGUAGE, "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"),
}
"""The variables that each keeps of its starter's environment. Engines of ablations read `AOS_WITHOUT`."""

_THREAD = 0x10000
_NAMESPACES = 0x7E020000
_NO_THREAD = 0x6000
"""CLONE_PTRACE and CLONE_VFORK."""

_WRITING = os.O_ACCMODE | os.O_CREAT | os.O_TRUNC | os.O_APPEND | 0o20000000
_DUPLICATE_WITHOUT_INHERITANCE = 1030
_TERMINAL_SETTINGS, _CLOSE_ON_EXEC, _KEEP_ON_EXEC, _BYTES_THERE, _NO_WAITING = (
    0x5401,
    0x5451,
    0x5450,
    0x541B,
    0x5421,
)


def program_of(profile: str, machine: str, pid: int, start: tuple[int, int, int]) -> bytes:
    """The filter for a profile. Process `pid` may execute once, with arguments at the addresses `start`.

    Nobody else's memory has its strings at these addresses, which are drawn anew for each process.
    """
    if profile == "compiler":
        return _compiler(machine)
    refusal = TRAP if profile == "engine" else _REFUSED
    conditional = _own(pid, start, refusal)
    named = {rule.name for rule in conditional}
    refused = (
        *calls.NETWORK, *calls.OTHER_PROCESSES, *calls.CHANGES_OF_OWNERS, *calls.CHANGES_OF_FILES,
        *calls.NEW_PROCESSES, *calls.SYSTEM,
    )  # fmt: skip
    rules = [
        *(Rule(name) for name in calls.ALLOWED),
        *conditional,
        # Libraries do without other calls. These are what nobody calls by accident.
        *(Rule(name, refusal) for name in refused if name not in named),
    ]
    return assemble(rules, machine, default=_REFUSED, newest=calls.NEWEST_KNOWN, newer=_ABSENT)


def _own(pid: int, start: tuple[int, int, int], refusal: int) -> list[Rule]:
    """The calls of engine and worker whose arguments decide."""
    reading = (_32_BITS & _WRITING, os.O_RDONLY)
    commands = (0, 1, 2, 3, 4, _DUPLICATE_WITHOUT_INHERITANCE)
    requests = (_TERMINAL_SETTINGS, _CLOSE_ON_EXEC, _KEEP_ON_EXEC, _BYTES_THERE, _NO_WAITING)
    thread = (0, _THREAD | _NAMESPACES | _NO_THREAD, _THREAD)
    return [
        Rule("execve", alternatives=[[(i, _64_BITS, start[i]) for i in range(3)]], otherwise=refusal),
        Rule("clone", alternatives=[[thread]], otherwise=refusal),
        Rule("clone3", _ABSENT),
        *(Rule(name, alternatives=[[(0, _32_BITS, pid)]], otherwise=refusal) for name in ("kill", "tgkill")),
        Rule("open", alternatives=[[(1, *reading)]], otherwise=refusal),
        Rule("openat", alternatives=[[(2, *reading)]], otherwise=refusal),
        # Another process's limits could end it. Those of this one are for its guard to set.
        Rule("prlimit64", alternatives=[[(0, _32_BITS, 0), (2, _64_BITS, 0)]], otherwise=_REFUSED),
        # Others would have signals sent to a process of one's choice.
        Rule("fcntl", alternatives=[[(1, _32_BITS, command)] for command in commands], otherwise=_REFUSED),
        Rule("ioctl", alternatives=[[(1, _32_BITS, request)] for request in requests], otherwise=_REFUSED),
        # A filter more takes only more away.
        Rule("seccomp", alternatives=[[(0, _32_BITS, 1), (1, _32_BITS, 0)]], otherwise=_REFUSED),
    ]


def _compiler(machine: str) -> bytes:
    refused = (*calls.NETWORK, *calls.OTHER_PROCESSES, *calls.CHANGES_OF_OWNERS, *calls.SYSTEM, "truncate")
    known_and_newer = ("close_range", "openat2", "faccessat2", "epoll_pwait2", "futex_waitv")
    process = (0, _NAMESPACES, 0)
    rules = [
        Rule("clone", alternatives=[[process]], otherwise=_REFUSED),
        Rule("clone3", _ABSENT),
        *(Rule(name, _REFUSED) for name in refused),
        *(Rule(name) for name in known_and_newer),
    ]
    return assemble(rules, machine, default=ALLOW, newest=calls.NEWEST_KNOWN, newer=_ABSENT)
