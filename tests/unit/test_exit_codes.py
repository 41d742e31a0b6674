import pytest
from commands import aos
from decision_records import decision_record

from aos_deploy.exit_codes import ExitCode, exit_code_of_error, exit_code_of_mission
from aos_deploy.runs.end import Account
from aos_protocol.errors import DeployError, error_from_code
from aos_protocol.messages import MissionState


@pytest.mark.parametrize(
    ("ending", "code"),
    [
        ("goal", 0),
        ("failure", 4),
        ("over", 8),
        ("nothing_worthwhile", 5),
        ("step_limit", 6),
        ("fault", 7),
        ("cancelled", 130),
    ],
)
def test_each_ending_has_its_exit_code(ending, code):
    assert exit_code_of_mission(MissionState("m", "ended", 1, 0.0, ending=ending)) == code


@pytest.mark.parametrize(
    ("code", "before", "after"),
    [
        ("AOS201", 1, 7),
        ("AOS501", 2, 7),
        ("AOS801", 1, 7),
        ("AOS110", 1, 7),
        ("AOS605", 3, 7),
        ("AOS802", 3, 7),
        ("AOS203", 3, 7),
    ],
)
def test_a_fault_counts_by_when_it_happens(code, before, after):
    error = error_from_code(code, "")
    assert exit_code_of_error(error) == before
    account = Account()
    early = account.stopped("m", error)
    assert early is not None
    assert exit_code_of_mission(early) == before
    account.take(decision_record(0, skill="pick"))
    late = account.stopped("m", error)
    assert late is not None
    assert exit_code_of_mission(late) == after == ExitCode.FAULT


@pytest.mark.parametrize(
    "command", ["logs --run nowhere", "drift nowhere", "decisions --connect tcp/127.0.0.1:1"]
)
def test_what_a_command_is_asked_wrongly_is_no_fault_of_a_deploy_file(command):
    done = aos(*command.split())
    assert isinstance(done.exception, DeployError | SystemExit)
    assert (done.exit_code, "AOS901" in f"{done.exception} {done.output}") == (1, True)
