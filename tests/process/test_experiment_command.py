import json
import sys
from pathlib import Path
from typing import Any

from places import DEPLOY
from processes import finished

AOS = Path(sys.executable).parent / "aos"

EXPERIMENT = f"""
aos: 1
title: The shipped robot
optimum: true
parts:
  finer:
    deploy: {DEPLOY}/armadillo.yaml
    simulations: 500
    step_limit: 8
    faults: {{arm_stays_out: 0.5}}
    claims:
      - {{says: it goes to the easy table, first: navigate(destination=easy_table)}}
      - {{says: it never picks, CHECK}}
"""


def test_an_experiment_goes_on_where_it_was_and_judges_changed_claims_anew(tmp_path):
    experiment, out = tmp_path / "mine.yaml", tmp_path / "out"

    def run(seeds: int, check: str) -> dict[str, Any]:
        experiment.write_text(EXPERIMENT.replace("CHECK", check))
        command = [AOS, "experiment", "run", experiment, "--seeds", str(seeds), "--out", out, "--json"]
        done = finished(*command)
        assert done.returncode == 0, done.stderr
        part: dict[str, Any] = json.loads(done.stdout)["parts"][0]
        return part

    first = run(3, "never: pick")
    assert [verdict["held"] for verdict in first["verdicts"]] == [3, 0]
    assert [verdict["is_seen"] for verdict in first["verdicts"]] == [True, False]
    optimum = first["regret"]["optimum"]
    # What `aos solve --stop-value 0` gives for these documents.
    assert 7.13 < optimum["lower"] <= optimum["upper"] < 7.15
    records = out / "model" / "finer" / "missions.jsonl"
    before = records.read_text()
    again = run(4, "some: pick")
    assert records.read_text().startswith(before)
    assert len(records.read_text().splitlines()) == 4
    assert [verdict["held"] for verdict in again["verdicts"]] == [4, 4]
    text = (out / "report.md").read_text()
    assert "| finer | it goes to the easy table | seen: 4 of 4 [" in text
    assert "## Beside the optimum" in text
    assert (out / "plots" / "steps.svg").is_file()
