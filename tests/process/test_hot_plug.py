"""Hot plug: skills that land in mid-mission are in use from the next decision on."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

BIN = Path(sys.executable).parent
SENSING = ("observe_holding", "observe_arm_outstretched")


@pytest.fixture
def deploy_file(root: Path, tmp_path: Path, cache_dir: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The shipped hot-plug deploy file on a free port, with runs of its own."""
    monkeypatch.setenv("AOS_CACHE_DIR", str(cache_dir))
    text = (root / "deploy" / "armadillo-hotplug.yaml").read_text()
    for old, new in {
        "tcp/127.0.0.1:7447": "tcp/127.0.0.1:0",
        "[bundles/": f"[{root}/deploy/bundles/",
        "world: worlds/": f"world: {root}/deploy/worlds/",
        "runs: ../runs": "runs: runs",
    }.items():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "hotplug.yaml"
    path.write_text(text)
    return path


def _events(process: subprocess.Popen[str]) -> Iterator[dict[str, Any]]:
    assert process.stdout is not None
    for line in process.stdout:
        yield json.loads(line)


def _push(bundle: Path, runs: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "aos", "bundle", "push", bundle, "--runs", runs], capture_output=True, text=True, check=False
    )


@pytest.mark.physics
def test_sensing_skills_pushed_after_the_pick_are_used_before_serving(
    root: Path, deploy_file: Path, tmp_path: Path
) -> None:
    runs = tmp_path / "runs"
    broken = tmp_path / "broken"
    broken.mkdir()
    for document in (root / "deploy/bundles/armadillo-finer").iterdir():
        text = document.read_text().replace("state.arm_outstretched ?", "state.arm_out_streched ?")
        (broken / document.name).write_text(text)

    decisions: list[dict[str, Any]] = []
    with subprocess.Popen([BIN / "aos-up", deploy_file, "--json"], stdout=subprocess.PIPE, text=True) as up:
        try:
            for event in _events(up):
                if event["event"] != "decision":
                    continue
                decisions.append(event)
                if event["skill"] == "pick" and "outcome" not in event and len(runs_of(decisions)) == 1:
                    refused = _push(broken, runs)
                    accepted = _push(root / "deploy/bundles/armadillo-finer", runs)
        finally:
            up.kill()

    assert refused.returncode == 1
    assert "arm_out_streched" in refused.stdout + refused.stderr
    assert accepted.returncode == 0
    first, last = decisions[0], decisions[-1]
    assert not any(value["action"] in SENSING for value in first["actions"])
    assert last["revision"] == first["revision"] + 1
    skills = [event["skill"] for event in decisions if "outcome" in event]
    if "serve" in skills:
        assert set(skills[: skills.index("serve")]) & set(SENSING)


def runs_of(decisions: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The decisions for a pick, so far."""
    return [event for event in decisions if event["skill"] == "pick" and "outcome" not in event]
