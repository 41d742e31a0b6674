import json
from pathlib import Path

import pytest
from commands import aos
from decision_records import decision_record
from typer.testing import CliRunner

from aos_deploy.cli import aos_app
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.drift import drift_of_runs
from aos_deploy.runs.record import RunRecord
from aos_protocol.messages import ActivationId, Outcome, PredictedObservation
from aos_protocol.mission_rows import DRIFT
from aos_runtime.disk.journal import Journal
from aos_solver.mission.rules.drift import begun

PREDICTED = (PredictedObservation("pressed", 0.9), PredictedObservation("stuck", 0.1))


def write_run(runs: Path, number: int, *responses: str, model: str = "d") -> Path:
    run = RunDirectory.create(runs, "lamp", now_ns=(1_700_000_000 + number) * 10**9)
    run.write_record(
        RunRecord(robot="lamp", endpoint="tcp/127.0.0.1:1", deploy_file="l.yaml", seed=1, started="", pid=1)
    )
    with Journal.open(run.path / "journal.db", survives_power_loss=False) as journal:
        journal.append(DRIFT, begun(model, {"press": ("pressed", "stuck"), "look": ("seen",)}))
        for step, response in enumerate(responses, 1):
            common = {"predicted": PREDICTED, "model_digest": model, "revision": number}
            journal.append("decision", decision_record(2 * step - 2, "m", "press", **common))
            outcome = Outcome(ActivationId("m", step), "press", "observed", response)
            journal.append("decision", decision_record(2 * step - 1, "m", "press", outcome=outcome, **common))
    run.close()
    return run.path


def test_an_alarm_comes_of_what_several_runs_have_seen_together(tmp_path):
    runs = [write_run(tmp_path, number, "stuck", "stuck") for number in (1, 2, 3)]
    for run in runs:
        (alone,) = drift_of_runs([run])
        assert not alone.begun_at
    (together,) = drift_of_runs(runs)
    assert (together.missions, together.revision) == (3, 3)
    assert {test.response: (test.uses, test.seen) for test in together.tests.tests} == {
        **{"pressed": (6, 0), "stuck": (6, 6)}
    }
    assert together.begun_at.keys() == {("press", "pressed"), ("press", "stuck")}
    assert together.begun_at["press", "stuck"].startswith(f"{runs[1].name}, step")


def test_each_model_has_tests_of_its_own_and_the_newest_decides(tmp_path, monkeypatch):
    worn = [write_run(tmp_path, number, *["stuck"] * 4) for number in (1, 2)]
    mended = write_run(tmp_path, 3, "pressed", "pressed", model="e")
    told = aos("drift", *worn, "--json")
    assert told.exit_code == 1
    ((pressed, stuck),) = [model["responses"] for model in json.loads(told.stdout)["models"]]
    assert (pressed["is_alarm"], stuck["uses"], stuck["modelled"]) == (True, 8, pytest.approx(0.1))
    told = aos("drift", *worn, mended)
    assert told.exit_code == 0
    assert [line.split(":")[0] for line in told.stdout.splitlines() if line.startswith("model")] == [
        *("model d, revision 2", "model e, revision 3")
    ]
    assert "does not hold since" in told.stdout
    words = ["drift", *map(str, worn), str(mended)]
    narrow = CliRunner().invoke(aos_app(words), words, env={"COLUMNS": "24"})
    assert sorted(filter(str.isalnum, narrow.stdout)) == sorted(filter(str.isalnum, told.stdout))
