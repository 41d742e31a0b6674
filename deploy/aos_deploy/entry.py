"""The programs `aos` and `aos-up`: Ctrl-C ends them without a word while Python still imports."""

import signal
from importlib import import_module


def main() -> None:
    """`aos`."""
    _run("main")


def up_main() -> None:
    """`aos-up`."""
    _run("up_main")


def _run(name: str) -> None:
    """Runs a program of the command line, whose imports take up to two seconds; Python would show the place
    that it has come to."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.default_int_handler:  # Else whoever started it may want it to go on.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    getattr(import_module("aos_deploy.cli"), name)(lambda: signal.signal(signal.SIGINT, before))
