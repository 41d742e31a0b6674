"""Fixtures that every kind of test may use."""

from __future__ import annotations

import contextlib
import os
import shutil
from pathlib import Path

import pytest

from aos_deploy.program import cache_dir as user_cache_dir

ROOT = Path(__file__).resolve().parents[1]
CACHE = ROOT / ".compiled"
CACHE_BYTES = 1_000_000_000
"""Two runs with other sources of the engine fit."""


@pytest.fixture(scope="session")
def root() -> Path:
    """The checkout."""
    return ROOT


@pytest.fixture(scope="session")
def bundles() -> Path:
    """Our own document bundles."""
    return ROOT / "deploy" / "bundles"


@pytest.fixture(scope="session")
def corpus() -> Path:
    """The original AOS bundles, third-party data beside the checkout; tests skip where it is absent."""
    folder = ROOT.parent / "shared" / "corpus"
    if not folder.is_dir():
        pytest.skip("needs the original AOS bundles in ../shared/corpus, which are not part of this project")
    return folder


@pytest.fixture(scope="session")
def cache_dir() -> Path:
    """Compiled models, kept from run to run, and the engines that setup.sh has compiled.

    An entry's name says what it was made from: a model of other documents or sources is not found by it.
    """
    CACHE.mkdir(exist_ok=True)
    for engine in user_cache_dir().glob("engine-*-*"):
        if engine.suffix not in (".building", ".lock"):
            with contextlib.suppress(FileExistsError):
                (CACHE / engine.name).symlink_to(engine)
    return CACHE


def pytest_configure(config: pytest.Config) -> None:
    """Makes room in the cache, once for all processes of a run."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        make_room(CACHE, CACHE_BYTES)


def make_room(folder: Path, limit_bytes: int) -> None:
    """Removes links to engines that are gone, and the entries unused for longest beyond so many bytes."""
    entries = [path for path in folder.glob("*-*") if not path.is_symlink()]
    for link in folder.glob("*-*"):
        if link.is_symlink() and not link.exists():
            link.unlink(missing_ok=True)
    total_bytes = 0
    for entry in sorted(entries, key=lambda path: path.stat().st_mtime, reverse=True):
        files = [entry] if entry.is_file() else [path for path in entry.rglob("*") if path.is_file()]
        total_bytes += sum(path.stat().st_size for path in files)
        if total_bytes > limit_bytes and entry.is_dir():
            shutil.rmtree(entry, ignore_errors=True)
        elif total_bytes > limit_bytes:
            entry.unlink(missing_ok=True)
