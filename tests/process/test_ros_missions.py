"""Whole missions over ROS: one aos-up serves the simulated robot as ROS nodes, another one drives it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from ros1_core import roscore, skip_without_ros1

from aos_runtime.parent import PARENT_VARIABLE

pytestmark = [pytest.mark.physics, pytest.mark.slow]

BIN = Path(sys.executable).parent
PATIENCE_S = 150.0

ORIGINAL_INTERFACES = {
    "robotican_demos_upgrade/srv/pick_unknown.srv": """string robot
string obj
string discrete_location
---
string result
""",
    "robotican_demos_upgrade/srv/arm_outstretched_indicator.srv": "---\nbool response\n",
    "robotican_demos_upgrade/srv/grasp_indicator.srv": "string object\n---\nbool response\n",
    "armadillo_navigation_upgrade/srv/navigate_srv.srv": """geometry_msgs/Point goal
float64 yaw
---
bool success
""",
}
"""The services that the original mappings call, as far as these show them."""

ROBOT = """aos: 1
robot: stand-in
project: iros
bundles: [{bundle}]
bus: {{listen: tcp/127.0.0.1:0}}
world: {root}/deploy/worlds/armadillo.yaml
bind:
  # The original places are those of another building.
  /custom_actions/navigate:
    pybullet: /navigate
    fields:
      x: 4.0 if goal.x < 6 else 0.0
      y: 0.0 if goal.x < 6 else 2.0 if goal.x < 8.5 else -2.0
      yaw: 0.0 if goal.x < 6 else 1.5708 if goal.x < 8.5 else -1.5708
  /pick_unknown: {{pybullet: /pick, fields: {{}}, result: {{result: "'true' if success else 'false'"}}}}
  /arm_outstretched_indicator: {{pybullet: /sense, result: {{response: "positions[3] > -2.3"}}}}
  /object_grasp_indicator:
    pybullet: /sense
    fields: {{}}
    result: {{response: "gap_m > 0.0003 and min(left_force_n, right_force_n) > 1.0"}}
  /deliver_to_person: {{pybullet: /serve}}
serve:
  interfaces: [interfaces]
  ros1: {{master: "{master}"}}
runs: runs
"""

MISSION = """aos: 1
robot: iros
bundles: [{bundle}]
bus: {{listen: tcp/127.0.0.1:0}}
mission: {{step_limit: 15}}
solver: {{simulations: 5000, seed: 1}}
adapters:
  armadillo: {{ros1: "{master}", interfaces: [interfaces]}}
bind: {{"*": armadillo}}
runs: runs
"""


@pytest.fixture
def master(tmp_path: Path) -> Iterator[str]:
    """The URI of a roscore."""
    skip_without_ros1()
    (tmp_path / "ros").mkdir()
    with roscore(tmp_path / "ros") as uri:
        yield uri


@contextmanager
def up(arguments: list[str], cache_dir: Path) -> Iterator[subprocess.Popen[str]]:
    """An aos-up that prints JSON events; it is stopped as by Ctrl-C."""
    with subprocess.Popen(
        [str(BIN / "aos-up"), "--json", *arguments],
        env={**os.environ, "AOS_CACHE_DIR": str(cache_dir)},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(PATIENCE_S)


def events_of(process: subprocess.Popen[str]) -> Iterator[dict[str, Any]]:
    assert process.stdout is not None
    for line in process.stdout:
        yield json.loads(line)


@pytest.mark.corpus
def test_an_unchanged_original_bundle_runs_a_mission_on_services_of_ros_1(
    master: str, corpus: Path, root: Path, cache_dir: Path, tmp_path: Path
) -> None:
    for name, text in ORIGINAL_INTERFACES.items():
        path = tmp_path / "interfaces" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    values = {"root": root, "bundle": corpus / "armadillo-rough", "master": master}
    for name, template in (("robot.yaml", ROBOT), ("mission.yaml", MISSION)):
        (tmp_path / name).write_text(template.format(**values))
    with up([str(tmp_path / "robot.yaml"), "--serve", "ros1"], cache_dir) as robot:
        told = list(events_of_until(robot, "Ctrl-C stops it"))
        assert any("/pick_unknown is robotican_demos_upgrade/srv/pick_unknown" in str(one) for one in told)
        with up([str(tmp_path / "mission.yaml")], cache_dir) as mission:
            events = list(events_of(mission))
    steps = [event for event in events if event["event"] == "decision" and event.get("outcome")]
    assert steps, events
    assert {step["outcome"]["status"] for step in steps} == {"observed"}
    summary = json.loads((tmp_path / "runs" / "latest" / "summary.json").read_text())
    assert summary["ending"] in ("goal", "failure", "nothing_worthwhile", "step_limit")
    assert any(action.startswith("navigate") for action in summary["actions"])
    assert mission.returncode in (0, 4, 5, 6)


def test_the_shipped_robot_serves_a_ros_2_program_of_others(
    root: Path, cache_dir: Path, tmp_path: Path
) -> None:
    pytest.importorskip("zenoh_ros2_sdk", reason="needs the package zenoh-ros2-sdk")
    arguments = [str(root / "deploy" / "armadillo-robot.yaml"), "--serve", "ros2", "--runs", str(tmp_path)]
    with up([*arguments, "--listen", "tcp/127.0.0.1:0"], cache_dir) as robot:
        list(events_of_until(robot, "Ctrl-C stops it"))
        run = json.loads((tmp_path / "latest" / "run.json").read_text())
        program = subprocess.run(
            [sys.executable, "-m", "tests.ros2_sdk_client", run["endpoint"].rpartition(":")[2]],
            cwd=root,
            env={**os.environ, PARENT_VARIABLE: str(os.getpid())},
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
        )
        assert program.stdout.splitlines()[-1:] == ["True 7"], program.stderr
    assert robot.returncode == 0


def events_of_until(process: subprocess.Popen[str], text: str) -> Iterator[dict[str, Any]]:
    """Events up to one that holds a text."""
    for event in events_of(process):
        yield event
        if text in str(event):
            return
    pytest.fail(f"aos-up ended before it said {text!r}")
