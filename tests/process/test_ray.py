"""Missions of the model on a Ray cluster: the same as here, and words for what is wrong with it.

Ray is in no lock: `pip install 'ray[client]'` into the environment makes these tests run.
"""

import asyncio
import sys
from importlib.util import find_spec
from pathlib import Path

import msgspec
import pytest
from commands import aos
from places import DEPLOY

from aos_lab.trials import ray_cluster
from aos_lab.trials.campaign import HERE, Place, play_campaign
from aos_lab.trials.setting import Setting
from aos_lab.trials.trial import Trial
from aos_protocol.errors import DeployError

# Ray leaves the processes that it starts to themselves.
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::UserWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)

needs_ray = pytest.mark.skipif(find_spec("ray") is None, reason="ray is not installed")


def play(out: Path, seeds: range, on: str, report: list[str] | None = None) -> list[Trial]:
    """The missions, without how long they took; `report` gets a line for each that is played or was."""
    setting = Setting(deploy="armadillo.yaml", simulations=2000, step_limit=6)
    lines = report if report is not None else []
    played = asyncio.run(
        play_campaign(
            setting,
            seeds,
            folder=DEPLOY,
            out=out,
            on_trial=lambda: lines.append("mission"),
            place=Place(on=on, jobs=2, on_progress=lines.append),
        )
    )
    return [msgspec.structs.replace(trial, seconds=0.0) for trial in played.trials]


@needs_ray
def test_missions_on_two_workers_are_those_of_this_machine_and_none_is_played_twice(tmp_path):
    here = play(tmp_path / "here", range(1, 7), HERE)
    there = play(tmp_path / "there", range(1, 5), ray_cluster.OWN)
    assert there == here[:4]
    lines: list[str] = []
    assert play(tmp_path / "there", range(1, 7), ray_cluster.OWN, lines) == here
    assert lines[:4] == ["mission"] * 4
    assert "processors of the Ray cluster ray" in lines[4]
    lines = []
    assert play(tmp_path / "there", range(1, 7), ray_cluster.OWN, lines) == here
    assert lines == ["mission"] * 6


@needs_ray
def test_a_machine_with_another_aos_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(ray_cluster, "_sources_of", lambda folders: ("9.9", "f" * 64))
    with pytest.raises(DeployError, match=r"has another AOS: .* there, 9\.9 with sources ffffffff here"):
        play(tmp_path, range(1, 2), ray_cluster.OWN)


@needs_ray
def test_a_cluster_that_cannot_be_reached_is_told_with_what_to_look_at(tmp_path):
    with pytest.raises(DeployError) as caught:
        play(tmp_path, range(1, 2), "ray://127.0.0.1:9")
    assert caught.value.code == "AOS809"
    assert "ray://127.0.0.1:9 cannot be reached" in caught.value.message


class HeadWithFaults:
    """A head whose first processes for clients do not come up."""

    def __init__(self, faults: int):
        self.faults = faults

    def init(self, address: str, **options: object):
        self.faults -= 1
        if self.faults >= 0:
            raise ConnectionAbortedError("Initialization failure from server:\n\nno process came up")


def test_a_head_whose_process_for_this_client_did_not_come_up_is_asked_once_more():
    ray_cluster._connect(HeadWithFaults(1), "ray://127.0.0.1:9")
    with pytest.raises(DeployError) as caught:
        ray_cluster._connect(HeadWithFaults(2), "ray://127.0.0.1:9")
    assert caught.value.message.endswith("Initialization failure from server: no process came up")


def test_without_ray_the_command_says_how_to_install_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(DeployError, match=r"aos-autonomy\[ray\]") as caught:
        play(tmp_path, range(1, 2), "ray://127.0.0.1:9")
    assert caught.value.code == "AOS805"


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--on", "cluster:10001"], "is none of local, ray://HOST:PORT"),
        (["--on", "ray", "--system-seeds", "1"], "missions of the whole system are run here"),
    ],
)
def test_a_place_where_missions_cannot_run_is_refused_before_anything_runs(options, text):
    done = aos("experiment", "run", "armadillo", *options)
    assert done.exit_code == 2
    assert text in " ".join(done.stderr.split())
