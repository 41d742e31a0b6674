import json

import pytest
from kept_cache import kept_cache, link_engines
from test_missions import up

from aos_deploy.history_check.files import check_run


@pytest.fixture(autouse=True)
def compiles(tmp_path, monkeypatch):
    link_engines(kept_cache(), tmp_path / "cache")
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path / "cache"))


def test_the_only_mission_is_cancelled_while_its_model_compiles(tmp_path):
    with up(tmp_path, "tiger.yaml") as system:
        system.until("mission", phase="compiling")
        answer = json.loads(system.aos("mission", "stop", "--json")[1])
        assert (answer["phase"], answer["ending"]) == ("ended", "cancelled")
        assert answer["remark"] == "stopped by hand before it began"
        told = system.until("mission", phase="ended")
        assert (told["ending"], told["remark"]) == ("cancelled", answer["remark"])
        assert system.process.wait() == 130
        summary = json.loads((system.run / "summary.json").read_text())
        assert (summary["ending"], summary["actions"]) == ("cancelled", [])
        assert check_run(system.run).violations == []


def test_the_first_mission_of_a_system_that_stays_does_not_begin_and_the_next_one_may(tmp_path):
    with up(tmp_path) as system:
        system.until("mission", phase="compiling")
        code, said, _ = system.aos("mission", "stop")
        assert (code, said) == (0, f"{system.run.name}-1 does not begin: stopped by hand\n")
        told = system.until("mission", phase="waiting", remark="stopped by hand")
        assert told["step"] == 0
        system.until(
            "remark",
            text="the mission does not begin: stopped by hand; `aos mission start` begins one, "
            "Ctrl-C stops the system",
        )
        assert system.aos("mission", "list")[1] == "no mission has begun\n"
        assert system.aos("mission", "start")[1] == f"{system.run.name}-1 has begun\n"
        system.until("mission", phase="ended", ending="step_limit")
        assert system.interrupt() == 0
        assert check_run(system.run).violations == []
