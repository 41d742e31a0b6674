import json
from pathlib import Path

import pytest
from commands import aos
from places import DATA

TIGER = DATA / "bundles" / "tiger"


@pytest.fixture
def deploy(tmp_path: Path) -> Path:
    """A deploy file of the tiger that looks two decisions ahead, and makes four."""
    file = tmp_path / "tester.yaml"
    file.write_text(
        f"aos: 1\nrobot: tester\nproject: tiger\nbundles: [{TIGER}]\n"
        "solver: {horizon: 2}\nmission: {step_limit: 4}\n"
    )
    return file


def test_a_plan_looks_as_far_ahead_as_the_deploy_file_says(deploy: Path):
    of_file, of_two, of_document = (
        aos("plan", *what, "--exact", "--json").stdout
        for what in ([deploy], [TIGER, "--horizon", "2"], [TIGER])
    )
    assert of_file == of_two != of_document
    assert aos("plan", deploy, "--exact", "--json", "--horizon", "1").stdout != of_two


def test_simulated_missions_look_as_far_ahead_and_are_as_long_as_the_deploy_file_says(deploy: Path):
    options = ["--runs", "3", "--simulations", "200", "--planner", "pomcp", "--json"]
    of_file, of_two, of_document = (
        json.loads(aos("simulate", *what, *options).stdout)["runs"]
        for what in ([deploy], [TIGER, "--horizon", "2", "--step-limit", "4"], [TIGER, "--step-limit", "4"])
    )
    assert of_file == of_two != of_document
