import json
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from aos_deploy.export.run_bundle import opened_bundle
from aos_gateway.resources import run_files
from aos_gateway.runs.shelf import RunShelf
from aos_protocol.errors import DeployError, GatewayError, StorageError

PIDS = {"solver": 1, "../../secret": 1}
RECORD = {"robot": "r", "endpoint": "", "deploy_file": "x", "seed": 1, "started": "", "pid": 1, "pids": PIDS}


def opened(place: Path, *entries: str) -> list[Path]:
    with zipfile.ZipFile(place / "sent.aosrun", "w") as archive:
        for name in entries:
            archive.writestr(name, json.dumps(RECORD))
    return opened_bundle(place / "sent.aosrun")


@pytest.fixture(autouse=True)
def _own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path / "cache"))


@pytest.mark.parametrize(
    "name", ["../x/run.json", "/x/run.json", "r/../../x/run.json", "r\x1b[2J/run.json", "r\n/run.json"]
)
def test_an_entry_that_is_no_file_of_a_run_is_refused(tmp_path, name):
    with pytest.raises(DeployError, match="is not a plain file within it") as caught:
        opened(tmp_path, name)
    assert caught.value.message.isprintable()


def test_a_file_that_is_also_a_folder_is_refused(tmp_path):
    with pytest.raises(DeployError, match="is not a file of runs"):
        opened(tmp_path, "r", "r/run.json")


async def test_folders_in_place_of_files_are_told_and_no_log_is_read_elsewhere(tmp_path):
    runs = opened(tmp_path, "r/run.json", "r/logs/solver.log/x", "r/pictures/step-1.png/x", "r/secret.log")
    gateway: Any = SimpleNamespace(shelf=RunShelf([], [], runs))
    with pytest.raises(StorageError, match="cannot be read"):
        await run_files.log(gateway, "r", "solver", run_files.OfLog())
    with pytest.raises(StorageError, match="cannot be read"):
        await run_files.picture(gateway, "r", "1")
    with pytest.raises(GatewayError, match="has no service"):
        await run_files.log(gateway, "r", "../secret", run_files.OfLog())
    with pytest.raises(GatewayError, match="has no service"):
        await run_files.log(gateway, "r", "../../secret", run_files.OfLog())
