"""A run whose journal has lost its last rows, as a write-ahead log that was cut off: it is not taken up."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest
from decision_records import decision_record

from aos_deploy.run_directory import RunRecord
from aos_deploy.taking_up import take_up
from aos_protocol.errors import AosError
from aos_protocol.messages import Activate, ActivationId, MissionBegun, Outcome, SkillCall
from aos_runtime.journal import Journal

MISSION = "run"
STEPS = 2


def intended(step: int) -> Activate:
    return Activate(ActivationId(MISSION, step), "go", {}, 10.0, 1)


def write_run(run: Path, journalled_steps: int, ledger: str) -> None:
    """A run whose ledger was asked for `STEPS` steps, and one call by hand."""
    run.mkdir()
    record = RunRecord(robot="r", endpoint="", deploy_file=str(run / "gone.yaml"), seed=1, started="", pid=1)
    (run / "run.json").write_bytes(msgspec.json.encode(record))
    with Journal.open(run / "journal.db", survives_power_loss=False) as journal:
        journal.append("begun", MissionBegun(MISSION, 1, 1, 1, "digest"))
        for step in range(1, journalled_steps + 1):
            decision = decision_record(2 * step - 2, MISSION, "go", action="go", parameters={})
            outcome = Outcome(ActivationId(MISSION, step), "go", "observed", "arrived")
            journal.append("decision", decision)
            journal.append("intended", intended(step))
            journal.append("outcome", outcome)
            journal.append("decision", msgspec.structs.replace(decision, outcome=outcome))
    with Journal.open(run / ledger, survives_power_loss=False) as asked:
        for id in [ActivationId(MISSION, step) for step in range(1, STEPS + 1)] + [
            ActivationId("by-hand", 7)
        ]:
            is_adapter = ledger.startswith("adapter")
            call = SkillCall(id, "/go", {}, 1.0) if is_adapter else Activate(id, "go", {}, 1.0)
            asked.append("started", call)


def refusal(run: Path) -> AosError:
    with pytest.raises(AosError) as refused:
        take_up(run)
    return refused.value


@pytest.mark.parametrize("ledger", ["middleware.db", "adapter-arm.db"])
def test_a_journal_that_did_not_intend_what_was_asked_for_is_refused(tmp_path: Path, ledger: str) -> None:
    run = tmp_path / MISSION
    write_run(run, STEPS - 1, ledger)
    error = refusal(run)
    assert error.code == "AOS702"
    assert f"did not intend run-2, for which {ledger} was asked" in str(error)


@pytest.mark.parametrize("ledger", ["middleware.db", "adapter-arm.db"])
def test_a_whole_journal_is_not_refused_for_a_call_by_hand(tmp_path: Path, ledger: str) -> None:
    run = tmp_path / MISSION
    write_run(run, STEPS, ledger)
    assert "gone.yaml" in str(refusal(run)), "the deploy file is looked for after the journal"
