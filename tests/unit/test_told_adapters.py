import os
import tempfile
from pathlib import Path
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace

from aos_protocol.errors import DeployError
from aos_runtime.adapters import AdapterSettings, Binding
from aos_runtime.adapters.host import load_adapter
from aos_runtime.adapters.settings import settings_told

HERE = {"AOS_ENDPOINT": "tcp/127.0.0.1:7447", "AOS_ROBOT": "fetch", "AOS_ADAPTER": "arm"}


@pytest.fixture
def written(tmp_path) -> dict[str, str]:
    run = tmp_path / "20260101T000000Z-fetch"
    settings = AdapterSettings(
        robot="fetch",
        service="arm",
        endpoint=HERE["AOS_ENDPOINT"],
        run_dir=str(run),
        adapter="",
        options={"command": ["python"]},
        bind={"/pick": Binding(target="grasp")},
    )
    path = tmp_path / "arm.json"
    path.write_bytes(msgspec.json.encode(settings))
    return {**HERE, "AOS_SETTINGS": str(path)}


def settings_of(words: list[str], environment: dict[str, str]) -> AdapterSettings:
    settings = settings_told(words, environment)
    assert settings is not None
    return settings


def test_a_class_of_a_module_is_told_what_is_bound_to_it(written: dict[str, str], tmp_path):
    settings = settings_of(["my_arm.adapter:Arm", "port=/dev/ttyUSB0", "baud=9600", "slow=true"], written)
    assert (settings.adapter, settings.folder) == ("my_arm.adapter:Arm", str(Path.cwd()))
    assert settings.bind == {"/pick": Binding(target="grasp")}
    assert not settings.serves_others
    assert settings.run_dir == str(tmp_path / "20260101T000000Z-fetch")
    assert settings.options == {"command": ["python"], "port": "/dev/ttyUSB0", "baud": 9600, "slow": True}


def test_a_class_of_a_file_is_imported_from_its_folder(written: dict[str, str]):
    settings = settings_of(["drivers/arm.py:Arm"], written)
    assert (settings.adapter, settings.folder) == ("arm:Arm", str(Path.cwd() / "drivers"))
    of_deploy_file = replace(settings, adapter="drivers/arm.py:Arm", folder="/robot")
    assert of_deploy_file.class_place == ("/robot/drivers", "arm:Arm")
    assert replace(of_deploy_file, adapter="arm:Arm").class_place == ("/robot", "arm:Arm")


def test_started_by_hand_it_serves_what_it_has(monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    settings = settings_of(["arm:Arm"], HERE)
    assert settings.serves_others
    assert (settings.robot, settings.service, settings.endpoint) == tuple(
        HERE[name] for name in ("AOS_ROBOT", "AOS_ADAPTER", "AOS_ENDPOINT")
    )
    assert Path(settings.run_dir).is_dir()


def test_on_another_host_it_keeps_its_ledger_there(written: dict[str, str], monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    settings = settings_of(["arm:Arm"], {**written, "AOS_ENDPOINT": "tcp/127.0.0.1:23456"})
    assert settings.run_dir == str(tmp_path / f"aos-{os.getuid()}" / "20260101T000000Z-fetch")
    assert settings.endpoint == "tcp/127.0.0.1:23456"


def test_nobody_else_has_the_folder_of_the_ledger(written: dict[str, str], monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder, there = tmp_path / f"aos-{os.getuid()}", {**written, "AOS_ENDPOINT": "tcp/127.0.0.1:23456"}
    folder.mkdir(mode=0o777)
    settings_of(["arm:Arm"], there)
    assert folder.stat().st_mode & 0o777 == 0o700
    folder.rename(tmp_path / "elsewhere")
    folder.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(SystemExit):
        settings_told(["arm:Arm"], there)


def test_a_settings_file_is_left_to_the_service():
    assert settings_told(["arm.json"], HERE) is None


def test_an_adapter_whose_file_is_no_python_is_told_with_its_line(tmp_path, monkeypatch):
    (tmp_path / "unfinished_arm.py").write_text(
        "class Arm:\n    def start(self):\n        await self.serve()\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    host: Any = None
    with pytest.raises(DeployError) as told:
        load_adapter("unfinished_arm:Arm", host)
    assert told.value.code == "AOS802"
    place = f"{tmp_path / 'unfinished_arm.py'}:3"
    assert f"unfinished_arm:Arm cannot be loaded: {place}: 'await' outside" in told.value.message


ODD_ADAPTERS = """
class Bare:
    pass

class Arm:
    version = "1"
    def __init__(self, host): pass
    async def start(self): pass
    async def close(self): pass
"""


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Bare", "the adapter odd_arms:Bare cannot be made with its host: too many positional arguments"),
        ("Arm", "odd_arms:Arm is no adapter: it has no `call`"),
        ("Leg", "the adapter odd_arms:Leg cannot be loaded: module 'odd_arms' has no attribute 'Leg'"),
    ],
)
def test_a_class_that_is_no_adapter_is_told_before_it_serves(name, message, tmp_path, monkeypatch):
    (tmp_path / "odd_arms.py").write_text(ODD_ADAPTERS)
    monkeypatch.syspath_prepend(tmp_path)
    host: Any = None
    with pytest.raises(DeployError) as told:
        load_adapter(f"odd_arms:{name}", host)
    assert (told.value.code, told.value.message) == ("AOS802", message)
