import json
from pathlib import Path

import pytest
from commands import aos
from places import DATA

from aos_protocol.errors import PlanningError

NEVER = "open_left && state.is_left"


@pytest.fixture
def bundle() -> Path:
    return DATA / "bundles" / "tiger"


def test_a_plan_says_what_it_risks_and_what_is_too_risky(bundle: Path):
    done = aos("plan", bundle, "--simulations", "100", "--never", f"0.2: {NEVER}")
    assert f"listen: risks 0, 0.2 left of 0.2: never {NEVER}" in done.stdout
    assert "too risky: open_left" in done.stdout
    found = json.loads(aos("plan", bundle, "--json", "--never", f"0.2: {NEVER}").stdout)
    (constraint,) = found["constraints"]
    assert (constraint["risk"], constraint["left"], constraint["risks"]) == (0, 0.2, [0, 0.5, 0])
    assert found["forbidden"] == ["open_left"]


def test_a_plan_for_which_nothing_is_allowed_is_an_error(bundle: Path):
    done = aos("plan", bundle, "--never", "0.1: listen || open_left || state.is_left || open_right")
    assert isinstance(done.exception, PlanningError)
    assert done.exception.code == "AOS303"
    assert "the least risk is 1" in done.exception.message


def test_a_policy_file_keeps_to_constraints_that_came_after_it(bundle: Path, tmp_path):
    policy = tmp_path / "tiger.policy"
    aos("solve", bundle, "--time", "2", "--precision", "1", "--out", policy)
    options = ["--policy", str(policy), "--runs", "20", "--step-limit", "8", "--json"]
    free = json.loads(aos("simulate", bundle, *options, "--never", f"0.9: {NEVER}").stdout)
    bound = json.loads(aos("simulate", bundle, *options, "--never", f"0: {NEVER}").stdout)
    assert any("open_left" in run["actions"] for run in free["runs"])
    assert not any("open_left" in run["actions"] for run in bound["runs"])
    assert bound["summary"][f"violation_rate of {NEVER}"] == 0
