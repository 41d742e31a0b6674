import json
import os
from pathlib import Path

import pytest
from commands import aos
from places import DATA

from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.processes.program import programs_of_deployment
from aos_protocol.errors import DeployError, DocumentError, PlanningError
from aos_solver.offline.policy import Policy


@pytest.fixture
def tiger() -> Path:
    return DATA / "problems" / "tiger.pomdp"


@pytest.fixture
def bundle() -> Path:
    return DATA / "bundles" / "tiger"


def test_a_problem_file_is_solved_and_everything_is_written(tiger: Path, tmp_path):
    names = [tmp_path / name for name in ("t.pomdpx", "t.policy", "t.dot", "t.h")]
    options = ["--export", "--out", "--graph", "--c-header"]
    wanted = [part for pair in zip(options, names, strict=True) for part in pair]
    result = aos("solve", tiger, "--json", *wanted)
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    assert report["lower"] == pytest.approx(19.371, abs=2e-3)
    assert report["size"] == {"states": 2, "actions": 3, "observations": 2, "outcomes": 10}
    assert report["graph_nodes"] == 5
    assert [Path(path).name for path in report["written"]] == [name.name for name in names]
    assert report["history"][-1]["ending"] == report["ending"] == "precision"
    policy = Policy.load(tmp_path / "t.policy")
    assert policy.header.actions == ("listen", "open-left", "open-right")
    assert (tmp_path / "t.dot").read_text().startswith("digraph")
    assert "t_start[1]" in (tmp_path / "t.h").read_text()


def test_people_see_the_bounds_come_nearer(tiger: Path):
    result = aos("solve", tiger)
    lines = result.stdout.splitlines()
    assert lines[0].endswith("tiger.pomdp: 2 states, 3 actions, 2 observations, discount 0.95")
    assert lines[1].split() == ["seconds", "at", "least", "at", "most", "gap", "vectors"]
    assert lines[-1].startswith("the policy gives at least 19.371")


def test_small_rewards_have_bounds_in_digits_of_their_size(tmp_path):
    problem = tmp_path / "small.pomdp"
    problem.write_text(
        "discount: 0.5\nvalues: reward\nstates: 1\nactions: 1\nT: * identity\nR: * : * : * 0.000003\n"
    )
    lines = aos("solve", problem).stdout.splitlines()
    assert "none more than 0.0000060" in lines[-1]


def test_a_policy_of_a_bundle_plans_and_simulates(bundle: Path, tmp_path):
    saved = tmp_path / "tiger.policy"
    assert aos("solve", bundle, "--out", saved).exit_code == 0
    decided = json.loads(aos("plan", bundle, "--policy", saved, "--json").stdout)
    assert decided["action"] == "listen"
    assert decided["value"] == pytest.approx(19.371, abs=2e-3)
    options = ["--policy", saved, "--runs", "3", "--step-limit", "12", "--json"]
    campaign = json.loads(aos("simulate", bundle, *options).stdout)
    assert [run["steps"] for run in campaign["runs"]] == [12, 12, 12]
    assert all(run["actions"][0] == "listen" for run in campaign["runs"])


def test_mistakes_are_told_before_the_work_begins(tiger: Path, tmp_path):
    result = aos("solve", tiger, "--export", tmp_path / "tiger.txt")
    assert result.exit_code == 2
    assert "needs to end in .pomdp or .pomdpx" in result.output
    for option in ("--out", "--graph", "--c-header", "--export"):
        ending = "pomdp" if option == "--export" else "dot"
        result = aos("solve", tiger, option, tmp_path / "none" / f"tiger.{ending}")
        assert result.exit_code == 2
        assert "there is no folder" in result.output
    for option in ("--time", "--precision", "--discount", "--stop-value"):
        assert "nan is not a finite number" in aos("solve", tiger, option, "nan").output
    assert isinstance(aos("solve", tmp_path / "none.pomdp").exception, DocumentError)
    few = aos("solve", tiger, "--states", "1").exception
    assert "has 2 states, more than 1" in str(few)


def test_a_file_that_cannot_be_written_is_told_before_the_work_begins(tiger: Path, tmp_path, monkeypatch):
    assert "/dev/full cannot be written: No space" in aos("solve", tiger, "--out", "/dev/full").output
    reading, writing = os.pipe()
    with os.fdopen(reading), os.fdopen(writing, "w"):
        assert aos("solve", tiger, "--out", f"/dev/fd/{writing}").exit_code == 0
    monkeypatch.setattr("os.access", lambda path, mode: mode != os.W_OK)  # Root may write everywhere.
    result = aos("solve", tiger, "--out", tmp_path / "tiger.policy")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "cannot be written" in result.output


@pytest.mark.parametrize(("problem", "runs"), [("tiger.pomdp", 100), ("rover.pomdpx", 500)])
def test_missions_of_a_problem_file_return_what_its_policy_promises(tiger: Path, tmp_path, problem, runs):
    policy, path = tmp_path / "a.policy", tiger.with_name(problem)
    bounds = json.loads(aos("solve", path, "--out", policy, "--json").stdout)
    simulated = aos("simulate", path, "--policy", policy, "--runs", str(runs), "--json")
    summary = json.loads(simulated.stdout)["summary"]
    room = 4 * summary["stderr"] + 1e-2
    assert bounds["lower"] - room < summary["mean_discounted_return"] < bounds["upper"] + room


def test_missions_of_a_problem_file_need_a_policy_of_that_file(tiger: Path, tmp_path):
    assert "aos solve" in aos("simulate", tiger).output
    policy = tmp_path / "a.policy"
    aos("solve", tiger.with_name("costs.pomdp"), "--out", policy)
    other = aos("simulate", tiger, "--policy", policy).exception
    assert isinstance(other, PlanningError)
    assert other.code == "AOS322"
    assert "--set" in aos("simulate", tiger, "--policy", policy, "--set", "a=1").output


def test_a_discount_of_one_is_refused_before_states_are_listed_and_anything_is_printed(
    tiger: Path, bundle: Path
):
    # With so few states allowed listing them would be refused, too.
    for arguments in ((tiger,), (bundle, "--states", "1")):
        refused = aos("solve", *arguments, "--discount", "1")
        assert isinstance(refused.exception, PlanningError)
        assert (refused.exception.code, refused.stdout) == ("AOS320", "")
        assert "--discount 0.99" in str(refused.exception)


def test_a_deploy_file_names_a_policy(tmp_path):
    (tmp_path / "rover").mkdir()
    head = "aos: 1\nrobot: rover\nbundles: [rover]\n"
    (tmp_path / "a.policy").write_text("")
    (tmp_path / "rover.yaml").write_text(f"{head}solver: {{policy: a.policy}}\n")
    deployment = read_deploy_file(tmp_path / "rover.yaml")
    solver = programs_of_deployment(deployment)[-1]
    assert solver.settings["policy"] == str(tmp_path / "a.policy")
    (tmp_path / "rover.yaml").write_text(f"{head}solver: {{policy: b.policy}}\n")
    with pytest.raises(DeployError) as caught:
        read_deploy_file(tmp_path / "rover.yaml")
    (finding,) = caught.value.diagnostics
    assert (finding.code, finding.span.line, finding.span.column) == ("AOS101", 4, 18)
    assert "there is no policy file" in finding.message
