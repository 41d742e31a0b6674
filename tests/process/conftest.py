import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from gateway import Gateway, copied_past, gateway, slow_system
from models import built_bundle
from places import BUNDLES
from supervised_system import TESTS, System

from aos_solver.building.build import BuiltModel


@pytest.fixture
def system(tmp_path, monkeypatch) -> System:
    monkeypatch.setenv("PYTHONPATH", str(TESTS))
    return System(tmp_path)


@pytest.fixture(scope="module")
def past(tmp_path_factory) -> Iterator[tuple[Gateway, str]]:
    """A gateway, and a mission that has run to its end: one for all processes of a run of the tests."""
    base = tmp_path_factory.getbasetemp()
    shared = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "played"
    folder = tmp_path_factory.mktemp("past")
    run = copied_past(shared, folder)
    with gateway(folder) as served:
        yield served, run.name


@pytest.fixture
def living(tmp_path) -> Iterator[tuple[Gateway, Path]]:
    with slow_system(tmp_path) as run, gateway(tmp_path) as served:
        yield served, run


@pytest.fixture
async def tiger() -> BuiltModel:
    return await built_bundle(BUNDLES / "bench" / "tiger")
