"""Landlock, the kernel's restriction of a process's own access to files, by its three system calls.

What a ruleset handles is refused beneath every folder that no rule names. A file that was opened before stays
open. Sizes and rights are those of linux/landlock.h; the first version (Linux 5.13) suffices, and later ones
handle more.
"""

from __future__ import annotations

import ctypes
import errno
import os
import stat
import struct

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
"""The same numbers on all architectures."""
_VERSION_FLAG = 1
_PATH_BENEATH = 1

_EXECUTE_FILE, _WRITE_FILE, _READ_FILE, _READ_DIR = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_REMOVE_DIR, _REMOVE_FILE = 1 << 4, 1 << 5
_MAKE_CHAR, _MAKE_DIR, _MAKE_FILE, _MAKE_SOCK = 1 << 6, 1 << 7, 1 << 8, 1 << 9
_MAKE_FIFO, _MAKE_BLOCK, _MAKE_LINK = 1 << 10, 1 << 11, 1 << 12
_MOVE, _TRUNCATE, _IOCTL_DEVICE = 1 << 13, 1 << 14, 1 << 15

_FILE_RIGHTS = _EXECUTE_FILE | _WRITE_FILE | _READ_FILE | _TRUNCATE | _IOCTL_DEVICE
"""The rights that a rule for a file may have; others are of folders."""

READ = _READ_FILE | _READ_DIR
EXECUTE = READ | _EXECUTE_FILE
WRITE = (
    READ | _WRITE_FILE | _TRUNCATE | _REMOVE_DIR | _REMOVE_FILE | _MAKE_DIR | _MAKE_FILE | _MAKE_LINK | _MOVE
)

_CONNECT_AND_BIND_TCP = 3
_ABSTRACT_SOCKETS_AND_SIGNALS = 3
_REASONS = {
    errno.ENOSYS: "this kernel has no Landlock, which Linux has from 5.13 on",
    errno.EOPNOTSUPP: "Landlock is not among the security modules that this kernel was started with",
    errno.EPERM: "the container does not let programs use Landlock",
}


def version() -> int:
    """The version of Landlock that the kernel has, at least 1; OSError where it has none."""
    return _call(_CREATE_RULESET, None, 0, _VERSION_FLAG)


def why_missing(error: OSError) -> str:
    """The reason for the error of `version`, in words."""
    return _REASONS.get(error.errno or 0, f"Landlock does not answer: {error.strerror}")


def restrict_files(rules: Iterable[tuple[str, int]], known: int) -> None:
    """Leaves this process, and all that it starts, the rights named for each path, and no others; OSError.

    A path that does not exist gives nothing. `known` is the version to be used, at most the kernel's. The
    process must have given up new privileges before.
    """
    ruleset = _create(known)
    try:
        for path, rights in rules:
            _allow(ruleset, path, rights & _handled(known))
        _call(_RESTRICT_SELF, ruleset, 0)
    finally:
        os.close(ruleset)


def _handled(known: int) -> int:
    """The rights to files that a version can refuse."""
    rights = (1 << 13) - 1
    for since, right in ((2, _MOVE), (3, _TRUNCATE), (5, _IOCTL_DEVICE)):
        rights |= right if known >= since else 0
    return rights


def _create(known: int) -> int:
    attributes = struct.pack("=Q", _handled(known))
    if known >= 4:
        attributes += struct.pack("=Q", _CONNECT_AND_BIND_TCP)
    if known >= 6:
        attributes += struct.pack("=Q", _ABSTRACT_SOCKETS_AND_SIGNALS)
    return _call(_CREATE_RULESET, ctypes.c_char_p(attributes), len(attributes), 0)


def _allow(ruleset: int, path: str, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    try:
        if not stat.S_ISDIR(os.fstat(place).st_mode):
            rights &= _FILE_RIGHTS
        rule = struct.pack("=Qi", rights, place)
        _call(_ADD_RULE, ruleset, _PATH_BENEATH, ctypes.c_char_p(rule), 0)
    finally:
        os.close(place)


def _call(number: int, *arguments: object) -> int:
    libc = ctypes.CDLL(None, use_errno=True)
    words = [ctypes.c_long(word) if isinstance(word, int) else word for word in arguments]
    result: int = libc.syscall(ctypes.c_long(number), *words)
    if result < 0:
        reason = ctypes.get_errno()
        raise OSError(reason, os.strerror(reason))
    return result
