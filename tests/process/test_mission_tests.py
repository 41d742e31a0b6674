import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from places import DEPLOY
from processes import COMMAND_S, finished

AOS = Path(sys.executable).parent / "aos"

MISSIONS = f"""
aos: 1
tests:
  finer:
    deploy: {DEPLOY}/armadillo.yaml
    bundles: [{DEPLOY}/bundles/armadillo-finer]
    seeds: 2
    simulations: 500
    step_limit: 4
    claims:
      - {{says: it goes to the easy table, first: navigate(destination=easy_table)}}
      - {{says: it never picks, never: pick}}
"""


def test_claims_that_fail_are_told_with_their_missions(tmp_path):
    missions, junit = tmp_path / "missions.yaml", tmp_path / "junit.xml"
    missions.write_text(MISSIONS)

    def run(*options: str) -> subprocess.CompletedProcess[str]:
        return finished(AOS, "test", missions, "--keep", tmp_path / "kept", *options)

    first = run("--junit", str(junit))
    assert first.returncode == 4, first.stderr
    assert "ok     finer: it goes to the easy table: held in 2 of 2 missions" in first.stdout
    assert "FAILED finer: it never picks: held in 0 of 2 missions" in first.stdout
    assert ": navigate(destination=easy_table) > arrived, pick" in first.stdout
    cases = list(ElementTree.parse(junit).iter("testcase"))
    assert [case.find("failure") is None for case in cases] == [True, False]
    # What was recorded is not run again.
    records = tmp_path / "kept" / "finer" / "missions.jsonl"
    before = records.read_bytes()
    again = json.loads(run("--json").stdout)
    assert records.read_bytes() == before
    assert [verdict["held"] for verdict in again["finer"]["verdicts"]] == [2, 0]


def test_a_mission_that_the_model_plays_returns_what_the_simulated_one_returns(tmp_path):
    bundle = f"{DEPLOY}/bundles/armadillo-finer"
    deploy = tmp_path / "played.yaml"
    deploy.write_text(
        f"aos: 1\nrobot: armadillo\nbundles: [{bundle}]\nruns: runs\n"
        "mission: {step_limit: 8}\nsolver: {simulations: 500}\n"
    )
    up = [AOS.with_name("aos-up"), deploy, "--model", "--seed", "3"]
    subprocess.run(up, capture_output=True, check=False, timeout=COMMAND_S)
    simulate = ["simulate", bundle, "--runs", "1", "--seed", "3", "--simulations", "500", "--step-limit", "8"]
    done = subprocess.run([AOS, *simulate, "--json"], capture_output=True, check=True, timeout=COMMAND_S)
    (simulated,) = json.loads(done.stdout)["runs"]
    steps = (tmp_path / "runs/latest/model.jsonl").read_text().splitlines()
    assert sum(json.loads(step)["reward"] for step in steps) == pytest.approx(simulated["return"])


LOSSY_ROBOT = f"""
aos: 1
robot: armadillo
bundles: [{DEPLOY}/bundles/armadillo-finer]
mission: {{step_limit: 6, failure_limit: 2}}
skills: {{navigate: {{timeout_s: 0.3}}}}
bind: {{"*": model}}
"""

LOSSY_TEST = """
  {name}:
    deploy: robot.yaml
    by: system-model
    seeds: 1
    simulations: 500
    faults: {{{fault}: 1.0}}
    claims:
      - {{says: nothing is observed, first: navigate > no observation}}
      - {{says: the world, {claim}}}
"""

LOSSY_CLAIMS = {
    "failed_call": "endings: [skills_failed], never_state: robot_at=EasyTable",
    "lost_result": "endings: [skills_failed], some_state: robot_at=EasyTable",
    "navigate.no_answer": "some_state: robot_at=EasyTable",
}


def test_calls_fail_results_are_lost_and_answers_never_come_as_a_test_wants(tmp_path):
    (tmp_path / "robot.yaml").write_text(LOSSY_ROBOT)
    tests = [
        LOSSY_TEST.format(name=fault.replace(".", "-"), fault=fault, claim=claim)
        for fault, claim in LOSSY_CLAIMS.items()
    ]
    (tmp_path / "missions.yaml").write_text("aos: 1\ntests:" + "".join(tests))
    done = finished(AOS, "test", tmp_path / "missions.yaml", "--keep", tmp_path / "kept")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("ok     ") == 6
