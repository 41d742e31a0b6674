"""Fixtures that every kind of test may use."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pytest

from aos_deploy.program import cache_dir as user_cache_dir

ROOT = Path(__file__).resolve().parents[1]


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
def cache_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compiled models, shared by all tests of one run, and the engines that setup.sh has compiled."""
    folder = tmp_path_factory.getbasetemp()
    # pytest-xdist gives each process a folder of its own in that of the run.
    run = folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder
    cache = run / "cache"
    cache.mkdir(exist_ok=True)
    # An entry's name says what it was made from: engines of other sources are not found by it.
    for engine in user_cache_dir().glob("engine-*-*"):
        if engine.suffix not in (".building", ".lock"):
            with contextlib.suppress(FileExistsError):
                (cache / engine.name).symlink_to(engine)
    return cache
