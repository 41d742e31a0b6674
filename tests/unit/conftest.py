from pathlib import Path

import pytest


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "bundle").mkdir()
    for name in ("rover.ef", "drive.sd", "drive.am", "look.sd", "look.am"):
        (tmp_path / "bundle" / name).write_text("")
    (tmp_path / "room.yaml").write_text("")
    return tmp_path
