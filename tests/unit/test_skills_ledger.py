from pathlib import Path

import pytest

from aos_protocol.errors import SkillError
from aos_protocol.messages import ActivationId, SkillCall, SkillResult
from aos_runtime.adapters.running_call import CallLedger

ID = ActivationId("mission", 1)
CALL = SkillCall(ID, "/pick", {}, 10.0)


@pytest.fixture
def path(tmp_path) -> Path:
    return tmp_path / "skills.db"


def test_a_new_activation_may_move(path: Path):
    assert CallLedger(path).stored(ID) is None


def test_a_repeated_activation_gets_its_stored_answer_also_after_a_restart(path: Path):
    ledger = CallLedger(path)
    ledger.start(CALL)
    ledger.end(SkillResult(ID, {"success": True}))
    ledger.close()
    assert CallLedger(path).stored(ID) == SkillResult(ID, {"success": True})


def test_an_activation_that_never_ended_is_unknown_and_does_not_move_again(path: Path):
    ledger = CallLedger(path)
    ledger.start(CALL)
    ledger.close()
    with pytest.raises(SkillError) as error:
        CallLedger(path).stored(ID)
    assert error.value.code == "AOS504"


def test_a_repeated_activation_that_failed_fails_again_and_does_not_move(path: Path):
    ledger = CallLedger(path)
    ledger.start(CALL)
    ledger.fail(ID, SkillError("gripper jammed", code="AOS510"))
    ledger.close()
    with pytest.raises(SkillError, match="gripper jammed") as error:
        CallLedger(path).stored(ID)
    assert error.value.code == "AOS510"
