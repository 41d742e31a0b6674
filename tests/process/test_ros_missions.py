import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from deploy_files import world_without_pictures
from places import BIN, ROOT
from processes import HANG_S, events_of, finished
from ros1_core import roscore, skip_without_ros1

from aos_runtime.processes.parent import PARENT_VARIABLE

pytestmark = [pytest.mark.physics, pytest.mark.slow]


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

SERVED = """
serve:
  interfaces: [interfaces]
  ros1: {{master: "{master}"}}
"""

MISSION = """aos: 1
robot: iros
bundles: [{bundle}]
bus: {{listen: tcp/127.0.0.1:0}}
mission: {{step_limit: 3}}
solver: {{simulations: 5000, seed: 1}}
adapters:
  armadillo: {{ros1: "{master}", interfaces: [interfaces]}}
bind: {{"*": armadillo}}
runs: runs
"""


@pytest.fixture
def master(tmp_path) -> Iterator[str]:
    skip_without_ros1()
    (tmp_path / "ros").mkdir()
    with roscore(tmp_path / "ros") as uri:
        yield uri


@contextmanager
def up(arguments: list[str]) -> Iterator[subprocess.Popen[str]]:
    """An aos-up that prints JSON events; it is stopped as by Ctrl-C."""
    with subprocess.Popen(
        [str(BIN / "aos-up"), "--json", *arguments], stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(HANG_S)


@pytest.mark.corpus
def test_an_unchanged_original_bundle_runs_a_mission_on_services_of_ros_1(
    master: str, corpus: Path, tmp_path
):
    for name, text in ORIGINAL_INTERFACES.items():
        path = tmp_path / "interfaces" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    values = {"bundle": corpus / "armadillo-rough", "master": master}
    stand_in = original_on_our_robot(corpus, tmp_path)
    stand_in = stand_in.replace("robot: iros", "robot: stand-in\nproject: iros")
    (tmp_path / "robot.yaml").write_text(stand_in + SERVED.format(**values))
    (tmp_path / "mission.yaml").write_text(MISSION.format(**values))
    with up([str(tmp_path / "robot.yaml"), "--serve", "ros1"]) as robot:
        happened = list(events_of_until(robot, "Ctrl-C stops it"))
        assert any(
            "/pick_unknown is robotican_demos_upgrade/srv/pick_unknown" in str(one) for one in happened
        )
        with up([str(tmp_path / "mission.yaml")]) as mission:
            events = list(events_of(mission))
    assert_whole_mission(events, tmp_path / "runs" / "latest")
    assert mission.returncode in (0, 4, 5, 6)


@pytest.mark.corpus
def test_an_unchanged_original_bundle_runs_a_mission_on_our_robot_by_foreign_paths(corpus: Path, tmp_path):
    (tmp_path / "deploy.yaml").write_text(original_on_our_robot(corpus, tmp_path))
    with up([str(tmp_path / "deploy.yaml")]) as mission:
        events = list(events_of(mission))
    assert_whole_mission(events, tmp_path / "runs" / "latest")
    assert mission.returncode in (0, 4, 5, 6)
    summary = json.loads((tmp_path / "runs/latest/summary.json").read_text())
    assert any(action.startswith("navigate") for action in summary["actions"])
    moved = [json.loads(line) for line in (tmp_path / "runs/latest/world.jsonl").read_text().splitlines()]
    assert {step["path"] for step in moved} <= {"/navigate", "/pick", "/sense", "/serve"}


def original_on_our_robot(corpus: Path, folder: Path) -> str:
    """The deploy file of the documentation, with the places where bundle and world are."""
    world = world_without_pictures(folder)
    text = (ROOT / "docs" / "examples" / "armadillo-original.yaml").read_text()
    text = text.replace("[armadillo-rough]", f"[{corpus / 'armadillo-rough'}]")
    text = text.replace("step_limit: 15", "step_limit: 5")
    return text.replace("../../deploy/worlds/armadillo.yaml", str(world))


def assert_whole_mission(events: list[dict[str, Any]], run: Path):
    steps = [event for event in events if event["event"] == "decision" and event.get("outcome")]
    assert steps, events
    assert {step["outcome"]["status"] for step in steps} == {"observed"}
    summary = json.loads((run / "summary.json").read_text())
    assert summary["ending"] in ("goal", "failure", "nothing_worthwhile", "step_limit")


def test_the_page_about_ros_can_be_followed_to_the_first_activation_and_serves_a_program_of_others(tmp_path):
    pytest.importorskip("zenoh_ros2_sdk", reason="needs the package zenoh-ros2-sdk")
    page = (ROOT / "docs" / "ros.md").read_text(encoding="utf-8")
    serve, drive = re.findall(r"^\.venv/bin/aos-up (.*)$", page, re.MULTILINE)
    block = page.partition("The first one prints what it serves:")[2].split("```")[1]
    here = ["--runs", str(tmp_path / "robot"), "--listen", "tcp/127.0.0.1:0"]
    with up([*in_the_checkout(serve), *here]) as robot:
        texts = [str(event.get("text")) for event in events_of_until(robot, "Ctrl-C stops it")]
        for line in block.strip().splitlines():
            assert line == "..." or line in texts
        served = json.loads((tmp_path / "robot" / "latest" / "run.json").read_text())["ros2"]
        program = finished(
            sys.executable,
            "-m",
            "tests.ros2_sdk_client",
            served.rpartition(":")[2],
            cwd=ROOT,
            env={**os.environ, PARENT_VARIABLE: str(os.getpid())},
        )
        assert program.stdout.splitlines()[-1:] == ["True 7"], program.stderr
        (file,) = in_the_checkout(drive)
        # Where the page has the ports of a whole machine, a test has those that are free.
        text = Path(file).read_text().replace("tcp/127.0.0.1:7447", served)
        text = text.replace("bundles/", f"{ROOT}/deploy/bundles/").replace("100_000", "1_000")
        text = text.replace("[interfaces]", f"[{ROOT}/deploy/interfaces]").replace("../runs", "runs")
        (tmp_path / "mission.yaml").write_text(text)
        with up([str(tmp_path / "mission.yaml")]) as mission:
            first = next(event for event in events_of(mission) if event.get("outcome"))
            assert first["outcome"]["status"] == "observed"
    assert robot.returncode == 0
    summary = json.loads((tmp_path / "robot/latest/summary.json").read_text())
    assert (summary["ending"], summary["exit_code"], summary["steps"]) == ("stopped", 0, 0)


def in_the_checkout(arguments: str) -> list[str]:
    """Arguments of aos-up with their deploy file where it is."""
    return [str(ROOT / word) if word.endswith(".yaml") else word for word in arguments.split()]


def events_of_until(process: subprocess.Popen[str], text: str) -> Iterator[dict[str, Any]]:
    for event in events_of(process):
        yield event
        if text in str(event):
            return
    pytest.fail(f"aos-up ended before it said {text!r}")
