"""The programs `aos` and `aos-up`: Ctrl-C ends them without a word while Python still imports."""

import gc
import signal
import sys
from importlib import import_module
from typing import NoReturn

from aos_runtime.processes.ending import end


def main() -> NoReturn:
    """`aos`."""
    _run("main")


def up_main() -> NoReturn:
    """`aos-up`."""
    _run("up_main")


def _run(name: str) -> NoReturn:
    """Runs a program of the command line, whose imports take up to two seconds; Python would show the place
    that it has come to. What is imported leaves no garbage to collect."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # Else whoever started it may want it to go on.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    gc.disable()

    def has_imported() -> None:
        gc.freeze()
        gc.enable()
        signal.signal(signal.SIGINT, before)

    status: object = None
    try:
        getattr(import_module("aos_deploy.cli"), name)(has_imported)
    except SystemExit as error:
        status = error.code
    if isinstance(status, int | None):
        end(status or 0)
    sys.exit(str(status))
