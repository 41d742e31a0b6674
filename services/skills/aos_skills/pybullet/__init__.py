"""The simulated robot: a pybullet world and the skills that act in it. Only this package imports pybullet."""

import contextlib
import importlib
import os

_STDERR = 2


def _import_silently() -> None:
    """Imports pybullet, which writes when it was built on standard error, without that line.

    Where it is not installed, the module that needs it says so.
    """
    try:
        kept = os.dup(_STDERR)
    except OSError:
        return  # There is no standard error that it could write on.
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, _STDERR)
    os.close(nowhere)
    try:
        with contextlib.suppress(ImportError):
            importlib.import_module("pybullet")
    finally:
        os.dup2(kept, _STDERR)
        os.close(kept)


_import_silently()
