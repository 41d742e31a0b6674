import pytest
from commands import aos
from long_run import write_long_run


@pytest.mark.parametrize("is_killed", [True, False])
def test_a_mission_that_was_killed_is_told_apart_from_one_that_has_ended(tmp_path, is_killed, monkeypatch):
    monkeypatch.setenv("AOS_RUNNING_DIR", str(tmp_path / "running"))
    run = tmp_path / "runs" / write_long_run(tmp_path / "runs", 2, has_ended=not is_killed)
    told = aos("decisions", "--run", run)
    assert told.exit_code == 0
    assert told.stdout.count("step  2") == 2
    assert ("aos-up --resume" in told.stderr, "mission ended" in told.stdout) == (is_killed, not is_killed)


def test_a_mission_that_a_run_has_not_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("AOS_RUNNING_DIR", str(tmp_path / "running"))
    run = tmp_path / "runs" / write_long_run(tmp_path / "runs", 2)
    told = aos("decisions", "--run", run, "--mission", "5")
    assert "has no mission 5" in str(told.exception)
