"""Fixtures of the tests that start whole systems."""

from __future__ import annotations

from pathlib import Path

import pytest
from supervised_system import TESTS, System


@pytest.fixture
def system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> System:
    """A system of small services in a folder of its own."""
    monkeypatch.setenv("PYTHONPATH", str(TESTS))
    return System(tmp_path)
