import random
from pathlib import Path

import msgspec
import pytest
from decision_records import decision_record
from places import DEPLOY

from aos_deploy.deployment.reading import read_deploy_file, without_a_robot
from aos_deploy.history_check.files import check_run
from aos_deploy.missions.taking_up import take_up, worlds_text
from aos_deploy.runs.end import account_of
from aos_deploy.runs.record import RunRecord
from aos_protocol.errors import AosError, StorageError
from aos_protocol.messages import Activate, ActivationId, MissionBegun, Outcome, SkillCall
from aos_runtime.disk.journal import Journal, JournalRow

MISSION = "run"
STEPS = 2


def intended(step: int) -> Activate:
    return Activate(ActivationId(MISSION, step), "go", {}, 10.0, 1)


def write_run(run: Path, journalled_steps: int, ledger: str):
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
def test_a_journal_that_did_not_intend_what_was_asked_for_is_refused(tmp_path, ledger):
    run = tmp_path / MISSION
    write_run(run, STEPS - 1, ledger)
    error = refusal(run)
    assert error.code == "AOS702"
    assert f"did not intend run-2, for which {ledger} was asked" in str(error)


@pytest.mark.parametrize("ledger", ["middleware.db", "adapter-arm.db"])
def test_a_whole_journal_is_not_refused_for_a_call_by_hand(tmp_path, ledger):
    run = tmp_path / MISSION
    write_run(run, STEPS, ledger)
    assert "gone.yaml" in str(refusal(run)), "the deploy file is looked for after the journal"


@pytest.mark.parametrize("is_closed", [True, False], ids=["closed", "killed"])
def test_a_flipped_bit_of_a_journal_is_refused_or_changes_nothing_but_the_last_rows(tmp_path, is_closed):
    run = tmp_path / MISSION
    write_run(run, STEPS, "middleware.db")
    journal, log = run / "journal.db", run / "journal.db-wal"
    with Journal.open(journal) as writer:
        writer.append("intended", intended(STEPS + 1))
        if is_closed:
            writer._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        whole = writer.rows()
        kept = {path: path.read_bytes() for path in (journal, log)}
    draw, refused = random.Random(1), 0
    for _ in range(100):
        for path, content in kept.items():
            path.write_bytes(content)
        (run / "journal.db-shm").unlink(missing_ok=True)
        harmed = bytearray(kept[journal if is_closed else log])
        harmed[draw.randrange(len(harmed))] ^= 1 << draw.randrange(8)
        (journal if is_closed else log).write_bytes(harmed)
        rows = rows_read(run)
        refused += rows is None
        assert rows is None or rows == whole[: len(rows)]
    assert refused > 10 or not is_closed


def rows_read(run: Path) -> list[JournalRow] | None:
    """The rows of a run's journal, which all that read it can read; None where it is refused."""
    try:
        check_run(run)
        account_of(run).verdict()
        with Journal.read(run / "journal.db") as journal:
            return journal.rows()
    except StorageError as error:
        return None if error.code == "AOS702" else []


def test_who_takes_up_a_run_in_a_simulated_world_is_told_that_the_world_begins_anew():
    text = worlds_text(read_deploy_file(DEPLOY / "armadillo.yaml"))
    assert text.startswith("the world of pybullet begins anew")
    assert worlds_text(without_a_robot(read_deploy_file(DEPLOY / "armadillo.yaml"))) == ""
