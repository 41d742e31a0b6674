import subprocess
from pathlib import Path
from typing import Any

import pytest
from deploy_files import world_without_pictures
from places import BIN, BUNDLES, DEPLOY, ROOT
from processes import events_of, finished, until_taking_over

SENSING = ("observe_holding", "observe_arm_outstretched")


PATIENT_PICK = """
import asyncio
from pathlib import Path

class Patient:
    version = "1"

    def __init__(self, host):
        self.host = host

    async def start(self):
        await self.host.serve(*self.host.chosen(["/pick"]))

    async def call(self, call):
        while not Path(self.host.options["until"]).exists():
            await asyncio.sleep(0.02)
        return {"success": True}

    async def close(self):
        pass
"""
"""A pick that ends when a file is there: the mission waits for the pushes, and no clock decides."""


@pytest.fixture
def picked(tmp_path) -> Path:
    """The file that lets the pick end."""
    return tmp_path / "picked"


@pytest.fixture
def deploy_file(tmp_path, picked: Path) -> Path:
    (tmp_path / "patient.py").write_text(PATIENT_PICK)
    text = (DEPLOY / "armadillo-hotplug.yaml").read_text()
    for old, new in {
        "[bundles/": f"[{ROOT}/deploy/bundles/",
        "world: worlds/armadillo.yaml": f"world: {world_without_pictures(tmp_path)}",
        "runs: ../runs": "runs: runs",
        "/pick: pybullet": "/pick: patient",
        "\nbind:": f'\nadapters: {{patient: {{class: "patient:Patient", until: {picked}}}}}\nbind:',
    }.items():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "hotplug.yaml"
    path.write_text(text)
    return path


def _push(bundle: Path, runs: Path) -> subprocess.CompletedProcess[str]:
    return finished(BIN / "aos", "bundle", "push", bundle, "--runs", runs)


@pytest.mark.physics
def test_sensing_skills_pushed_during_the_pick_are_used_before_serving(
    deploy_file: Path, tmp_path, picked: Path
):
    runs = tmp_path / "runs"
    broken = tmp_path / "broken"
    broken.mkdir()
    for document in (BUNDLES / "armadillo-finer").iterdir():
        text = document.read_text().replace("state.arm_outstretched ?", "state.arm_out_streched ?")
        (broken / document.name).write_text(text)

    decisions: list[dict[str, Any]] = []
    pushed: list[subprocess.CompletedProcess[str]] = []
    with subprocess.Popen([BIN / "aos-up", deploy_file, "--json"], stdout=subprocess.PIPE, text=True) as up:
        try:
            for event in events_of(up):
                if event["event"] != "decision" or "outcome" in event:
                    continue
                decisions.append(event)
                if event["skill"] == "pick" and not pushed:
                    pushed = [_push(broken, runs), _push(BUNDLES / "armadillo-finer", runs)]
                    until_taking_over((runs / "latest").resolve(), decisions[0]["revision"] + 1)
                    picked.touch()
                elif event["skill"] in (*SENSING, "serve"):
                    break
        finally:
            up.kill()

    refused, accepted = pushed
    assert refused.returncode == 1
    assert "arm_out_streched" in refused.stdout + refused.stderr
    assert accepted.returncode == 0
    first, last = decisions[0], decisions[-1]
    assert not any(value["action"] in SENSING for value in first["actions"])
    assert last["revision"] == first["revision"] + 1
    assert last["skill"] in SENSING
