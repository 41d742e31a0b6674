"""A trial of the sandbox: a confined program that tries what it may not."""

import os
import subprocess
import sys
import tempfile

from aos_runtime.processes.children import Confinement, Limits, guarded
from aos_runtime.sandbox.places import library_folders, loader_of, python_folders

_TRIAL_S = 20.0
_PROGRAM = """
import os, socket, sys

def attempt(what, work):
    try:
        work()
    except OSError:
        return
    print(what)

attempt("reads files of its user", lambda: open(sys.argv[1]).close())
attempt("lists folders of its user", lambda: os.listdir(os.path.dirname(sys.argv[1])))
attempt("changes files of its user", lambda: os.chmod(sys.argv[1], 0o600))
attempt("opens connections", lambda: socket.socket().close())
attempt("starts processes", lambda: os._exit(0) if os.fork() == 0 else None)
attempt("ends other processes", lambda: os.kill(os.getppid(), 0))
print("tried")
"""


def what_a_confined_program_can() -> str:
    """Returns what a program can do in the sandbox that it may not, or why it does not run; empty if all is
    well."""
    loader = loader_of(os.path.realpath(sys.executable))
    with tempfile.NamedTemporaryFile() as canary:
        confinement = Confinement(
            profile="worker",
            read=(*library_folders(), *python_folders()),
            execute=(sys.executable, *([loader] if loader else [])),
        )
        command = [sys.executable, "-I", "-S", "-c", _PROGRAM, canary.name]
        try:
            done = subprocess.run(
                guarded(command, Limits(), confinement),
                capture_output=True, text=True, timeout=_TRIAL_S, check=False,
            )  # fmt: skip
        except (OSError, subprocess.TimeoutExpired) as error:
            return f"a confined program does not run: {error}"
    *can, last = done.stdout.splitlines() or [""]
    if last != "tried":
        return f"a confined program does not run: {done.stderr.strip()[-300:]}"
    return f"a confined program {', '.join(can)}" if can else ""
