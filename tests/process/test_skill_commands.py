import json
import re
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from commands import aos
from places import BIN
from processes import HANG_S, finished

ROBOT = """
from pathlib import Path

async def look(call):
    if Path(FOLDER, "dirty").exists():
        raise RuntimeError("the lens is dirty")
    return {"bearing_rad": -1.0}

async def take(call, side):
    call.progress(0.5, "reaching out")
    return {"success": side == "Right", "picture": b"\\xff", "force_n": float("nan")}
"""
DEPLOY = """\
aos: 1
robot: fetch
bundles: [fetch]
bus: {listen: tcp/127.0.0.1:0}
solver: {simulations: 1000}
skills: {look: {on_failure: hold}}
bind:
  /look: {python: robot.py:look}
  /take: {python: robot.py:take}
runs: runs
"""


class Running:
    def __init__(self, process: subprocess.Popen[str]):
        self.process = process
        self.events: list[dict[str, Any]] = []

    def until(self, **wanted: str) -> dict[str, Any]:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.events.append(json.loads(line))
            if wanted.items() <= self.events[-1].items():
                return self.events[-1]
        raise AssertionError(f"{wanted} did not come: {self.events[-3:]}")

    def aos(self, *arguments: str) -> str:
        command = [BIN / "aos", *arguments, "--runs", "runs"]
        done = finished(*command)
        return done.stdout + done.stderr


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    aos("new", "project", "fetch")
    look = tmp_path / "fetch" / "look.am"
    # A failure that a rule tells is an observation, at which no mission holds.
    look.write_text(look.read_text().replace('__skill_status == "failed"', '__skill_status == "cancelled"'))
    (tmp_path / "robot.py").write_text(f"FOLDER = {str(tmp_path)!r}\n{ROBOT}")
    (tmp_path / "fetch.yaml").write_text(DEPLOY)
    return tmp_path


@pytest.fixture
def mission(folder: Path) -> Iterator[Running]:
    """It holds, for the lens is dirty."""
    (folder / "dirty").touch()
    process = subprocess.Popen([BIN / "aos-up", "fetch.yaml", "--json"], stdout=subprocess.PIPE, text=True)
    try:
        yield Running(process)
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=HANG_S)


def test_a_mission_that_holds_can_be_helped_by_hand_and_goes_on(mission: Running, folder: Path):
    held = mission.until(event="mission", phase="holding")
    assert "look: failed, AOS510: /look failed: RuntimeError: the lens is dirty" in held["remark"]

    assert re.search(
        r"^take +/take +python 1 \(process \d+ on .+\)$", mission.aos("skill", "list"), re.MULTILINE
    )
    info = json.loads(mission.aos("skill", "info", "take", "--json"))
    assert info["fields"] == {"side": "side"}
    assert [by.partition(" (process ")[0] for by in info["served_by"]] == ["python 1"]
    called = mission.aos("skill", "call", "/take", "side=Right")
    assert '"success": true' in called
    assert "executing   50%  reaching out" in called
    assert '"picture": "b\'\\\\xff\'"' in called
    assert '"force_n": NaN' in called
    as_json = mission.aos("skill", "call", "/take", "side=Right", "--json")
    assert {"success": True, "picture": "/w==", "force_n": None} in map(json.loads, as_json.splitlines())
    assert "the lens is dirty" in mission.aos("skill", "call", "look")
    nobody = mission.aos("skill", "call", "lok")
    assert "AOS505: no adapter serves /lok. Did you mean `look`?" in nobody
    assert "there is no skill tke" in mission.aos("skill", "info", "tke")
    assert mission.aos("skill", "cancel") == "nothing was moving\n"
    assert mission.aos("skill", "cancel", "--json") == '{"stopped": []}\n'

    (folder / "dirty").unlink()
    assert mission.aos("resume") == "the mission goes on\n"
    mission.until(event="mission", phase="ended", ending="goal")
    assert mission.process.wait() == 0
