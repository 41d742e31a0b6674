import sqlite3
from pathlib import Path

import msgspec
import pytest
from decision_records import decision_record

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.end import Account, account_of, settled
from aos_deploy.runs.record import Summary
from aos_protocol.errors import DeployError, DocumentError, StorageError
from aos_protocol.messages import (
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    EndingOdds,
    MissionState,
    Outcome,
)
from aos_runtime.disk.journal import Journal

MISSION = "run"
KILLED = DeployError("registry ended unexpectedly: killed by SIGKILL", code="AOS804")


def decided(step: int) -> DecisionRecord:
    cautious = BeliefSummary((), 0.0, 0.25, 0.0, 1, True, cautious=EndingOdds(0.125, 0.0, 0.0))
    return decision_record(2 * step - 2, MISSION, belief=cautious)


def observed(step: int) -> DecisionRecord:
    outcome = Outcome(ActivationId(MISSION, step), "look", "observed", "seen")
    return msgspec.structs.replace(decided(step), sequence=2 * step - 1, outcome=outcome)


def ended(ending: str, remark: str = "") -> MissionState:
    return MissionState(MISSION, "ended", 1, 0.25, ending, remark, revision=1, epoch=1)


@pytest.fixture
def run(tmp_path) -> Path:
    path = tmp_path / MISSION
    path.mkdir()
    return path


def write(run: Path, *messages: DecisionRecord | MissionState):
    with Journal.open(run / "journal.db") as journal:
        for message in messages:
            journal.append("decision" if isinstance(message, DecisionRecord) else "mission", message)


def test_a_mission_that_has_ended_is_told_by_its_journal_alone(run: Path):
    write(run, decided(1), observed(1), ended("goal", "the goal is reached"))
    verdict, lacking = settled(run, Account(), stopped_by=None, was_interrupted=False)
    assert lacking is None
    assert (verdict.ending, verdict.remark, verdict.exit_code) == ("goal", "the goal is reached", 0)
    assert (verdict.steps, verdict.actions, verdict.responses) == (1, ("look",), ("seen",))
    assert (verdict.goal_probability, verdict.cautious_goal_probability) == (0.25, 0.125)


@pytest.mark.parametrize(
    ("stopped_by", "was_interrupted"), [(KILLED, False), (None, True)], ids=["killed", "interrupted"]
)
def test_what_comes_after_the_end_of_the_mission_changes_nothing(run: Path, stopped_by, was_interrupted):
    write(run, decided(1), observed(1), ended("step_limit"))
    verdict, _ = settled(run, Account(), stopped_by=stopped_by, was_interrupted=was_interrupted)
    assert (verdict.ending, verdict.exit_code) == ("step_limit", 6)
    with Journal.read(run / "journal.db") as journal:
        assert len(journal.rows()) == 3


@pytest.mark.parametrize(
    ("rows", "stopped_by", "ending", "code"),
    [
        ((decided(1),), KILLED, "fault", 7),
        ((decided(1),), None, "cancelled", 130),
        ((decided(1), ended("fault", "AOS607: lost")), KILLED, "fault", 7),
        ((), KILLED, "not_started", 3),
        ((), DocumentError("wrong", code="AOS120"), "not_started", 1),
        ((), None, "cancelled", 130),
    ],
)
def test_what_ends_a_run_from_outside_is_the_last_row_of_its_journal(
    run: Path, rows, stopped_by, ending, code
):
    write(run, *rows)
    verdict, lacking = settled(run, Account(), stopped_by=stopped_by, was_interrupted=stopped_by is None)
    assert lacking is None
    assert (verdict.ending, verdict.exit_code) == (ending, code)
    assert verdict.remark == (str(stopped_by) if stopped_by else "interrupted")
    assert account_of(run).verdict() == verdict


def test_a_run_whose_aos_up_was_killed_has_no_ending(run: Path):
    write(run, decided(1))
    verdict = account_of(run).verdict()
    assert (verdict.ending, verdict.steps, verdict.responses) == ("", 1, ("",))


def test_without_space_for_the_end_the_verdict_is_the_same(run: Path):
    write(run, decided(1))
    database = sqlite3.connect(run / "journal.db")
    database.execute("CREATE TRIGGER full BEFORE INSERT ON entries BEGIN SELECT RAISE(ABORT, 'full'); END")
    database.commit()
    database.close()
    verdict, lacking = settled(run, Account(), stopped_by=KILLED, was_interrupted=False)
    assert (verdict.ending, verdict.exit_code) == ("fault", 7)
    assert lacking.code == "AOS701"


@pytest.mark.parametrize("is_gone", [False, True])
def test_where_the_journal_is_damaged_or_gone_the_verdict_is_on_what_was_seen(run: Path, is_gone):
    write(run, decided(1), observed(1), ended("goal"))
    damaged = (run / "journal.db").read_bytes().replace(b'"look"', b'"loo\xff"')
    (run / "journal.db").write_bytes(damaged)
    if is_gone:
        (run / "journal.db").unlink()
    account = Account()
    for message in (decided(1), observed(1), ended("goal")):
        account.take(message)
    verdict, lacking = settled(run, account, stopped_by=None, was_interrupted=False)
    assert (verdict.ending, verdict.exit_code) == ("goal", 0)
    assert lacking.code == "AOS702"


def test_a_summary_is_written_whole_or_not_at_all(run: Path):
    directory = RunDirectory(run)
    summary = Summary(
        robot="r", deploy_file="d", seed=1, started="", services_ready_s=None, first_decision_s=None,
        duration_s=1.0, steps=0, **msgspec.structs.asdict(Account().verdict()),
    )  # fmt: skip
    directory.write_summary(summary)
    assert directory.read_summary() == summary
    (run / "summary.json").unlink()
    (run / "summary.json").mkdir()  # Nothing can be renamed onto a folder.
    with pytest.raises(StorageError, match="cannot be written: Is a directory") as raised:
        directory.write_summary(summary)
    assert raised.value.code == "AOS701"
    assert [path.name for path in run.iterdir() if "summary" in path.name] == ["summary.json"]
