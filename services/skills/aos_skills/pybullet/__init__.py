"""The simulated robot: a pybullet world and the skills that act in it. Only this package imports pybullet."""

import contextlib
import os

_STDERR = 2


def _import_silently() -> None:
    """Imports pybullet, which writes when it was built on standard error, without that line."""
    kept = os.dup(_STDERR)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), _STDERR)
    try:
        with contextlib.suppress(ImportError):
            import pybullet  # noqa: F401, PLC0415
    finally:
        os.dup2(kept, _STDERR)
        os.close(kept)


_import_silently()
