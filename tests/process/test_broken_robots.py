"""Whole systems of the tutorial's project whose robots are broken: docs/when-a-skill-fails.md."""

import contextlib
import subprocess
from pathlib import Path

import pytest
from commands import aos
from places import BIN
from processes import COMMAND_S
from walk import steps_of

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import Summary

ROBOT = """
import os


def ending(call, **fields):
    os._exit(3)


def broken(call, **fields):
    raise RuntimeError("it does not move")


def look(call):
    return {"bearing_rad": 0.4}


def ask(call):
    return {"response": "said_left"}


def take(call, side):
    return {"success": side == "Left"}
"""

DEPLOY = """\
aos: 1
robot: fetch
bundles: [fetch]
bus: {listen: "tcp/127.0.0.1:0"}
solver: {simulations: 10_000}
bind:
"""


@pytest.fixture
def project(tmp_path) -> Path:
    with contextlib.chdir(tmp_path):
        aos("new", "project", "fetch")
    (asks,) = (step.text for step in steps_of() if step.kind == "file: fetch/ask.sd")
    (tmp_path / "fetch" / "ask.sd").write_text(asks)
    (tmp_path / "robot.py").write_text(ROBOT)
    return tmp_path


def mission(project: Path, text: str = "", **functions: str) -> tuple[int, Summary]:
    binding = "".join(
        f"  /{skill}: {{python: robot.py:{function}}}\n" for skill, function in functions.items()
    )
    (project / "fetch.yaml").write_text(DEPLOY + binding + text)
    up = [BIN / "aos-up", "fetch.yaml", "--plain"]
    code = subprocess.run(up, cwd=project, capture_output=True, timeout=COMMAND_S).returncode
    summary = RunDirectory.latest(project / "runs").read_summary()
    assert summary is not None
    return code, summary


def test_with_a_broken_arm_the_goal_is_never_claimed(project: Path):
    look = project / "fetch" / "look.sd"
    look.write_text(look.read_text().replace("__reward = -1", "__reward = -0.3"))
    code, summary = mission(project, look="look", take="broken", ask="ask")
    assert (code, summary.ending, summary.goal_probability) == (9, "skills_failed", 0.0)
    why = "take is set aside for 300 s after 3 failures in a row, the last "
    assert why in summary.remark
    assert summary.responses.count("stuck") == 3
    assert [action.partition("(")[0] for action in summary.actions].count("take") == 3


def test_beside_a_camera_that_ends_its_adapter_in_each_call_the_robot_asks(project: Path):
    look = project / "fetch" / "look.sd"
    look.write_text(look.read_text().replace("0.85", "0.98"))
    code, summary = mission(project, look="ending", take="take", ask="ask")
    assert (code, summary.ending) == (0, "goal")
    assert summary.actions == ("look", "look", "look", "ask", "take(side=left_side)")


def test_two_skills_that_end_their_adapter_in_each_call_end_the_mission_and_not_the_run(project: Path):
    limit = "mission: {stop_below_value: 0.0}\n"
    code, summary = mission(project, limit, look="ending", take="ending", ask="ask")
    assert (code, summary.ending) == (9, "skills_failed")
    assert "take is set aside for 300 s after 3 failures in a row, the last unknown" in summary.remark
