"""Connections to Bullet that leave standard output to the program."""

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager

import pybullet
from pybullet_utils.bullet_client import BulletClient


def connect() -> BulletClient:
    """A simulation in this process, with no window.

    Bullet prints its own arguments, from C, whenever it connects; standard output is shut for that long.
    Standard error, where Bullet's warnings go, stays open.
    """
    with _silent_stdout():
        return BulletClient(connection_mode=pybullet.DIRECT)


@contextmanager
def _silent_stdout() -> Iterator[None]:
    """C buffers what it prints, so it is flushed on either side."""
    flush_c = ctypes.CDLL(None).fflush
    flush_c(None)
    stdout = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
        flush_c(None)
    finally:
        os.dup2(stdout, 1)
        os.close(stdout)
        os.close(nowhere)
