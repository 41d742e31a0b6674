"""Runs a command as on a kernel without Landlock: `python tests/without_landlock.py COMMAND...`.

A filter of system calls answers as such a kernel does, here and in all that the command starts.
"""

import errno
import os
import sys

from aos_runtime.sandbox.seccomp import ALLOW, assemble, fail_with, give_up_new_privileges, put_on

FIRST_CALL_OF_LANDLOCK = 444

if __name__ == "__main__":
    machine = os.uname().machine
    absent = fail_with(errno.ENOSYS)
    program = assemble([], machine, default=ALLOW, newest=FIRST_CALL_OF_LANDLOCK - 1, newer=absent)
    give_up_new_privileges()
    put_on(program, machine)
    os.execvp(sys.argv[1], sys.argv[1:])
