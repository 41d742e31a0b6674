"""The simulated robot: a pybullet world and the skills that act in it. Only this package imports pybullet."""

import contextlib
import os

_STDERR = 2


def _import_silently() -> None:
    """Imports pybullet, which writes when it was built on standard error, without that line."""
    kept = os.dup(_STDERR)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, _STDERR)
    os.close(nowhere)
    try:
        with contextlib.suppress(ImportError):
            import pybullet  # noqa: F401
    finally:
        os.dup2(kept, _STDERR)
        os.close(kept)


_import_silently()
