"""The programs `aos` and `aos-up`: Ctrl-C ends them without a word while Python still imports."""

import signal
from importlib import import_module
from typing import Any


def main() -> None:
    """`aos`."""
    _command_line().main()


def up_main() -> None:
    """`aos-up`."""
    _command_line().up_main()


def _command_line() -> Any:
    """Imports the command line, which takes up to a second; Python would show the place it has come to."""
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler:  # Whoever started it may want it to go on.
        return import_module("aos_deploy.cli")
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        return import_module("aos_deploy.cli")
    finally:
        signal.signal(signal.SIGINT, before)
