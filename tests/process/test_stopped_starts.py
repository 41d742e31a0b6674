import json
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from kept_cache import kept_cache, link_engines
from processes import descendants
from test_missions import System, up

from aos_deploy.history_check.files import check_run


@pytest.fixture(autouse=True)
def compiles(tmp_path, monkeypatch):
    link_engines(kept_cache(), tmp_path / "cache")
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path / "cache"))


@contextmanager
def stopped_compiler(system: System) -> Iterator[None]:
    """The compiler goes on after the block, in which a command may take longer than the compiler needs."""
    system.until("mission", phase="compiling")
    solver, stopped = system.record["pids"]["solver"], set[int]()
    while not stopped or others_than(solver) - stopped:
        for pid in others_than(solver) - stopped:
            os.kill(pid, signal.SIGSTOP)
            stopped.add(pid)
    yield
    for pid in stopped:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGCONT)


def others_than(solver: int) -> set[int]:
    """Its children; one that was forked and runs no program yet would keep the solver with it."""
    command = Path(f"/proc/{solver}/cmdline").read_bytes()
    return {pid for pid in descendants(solver) if Path(f"/proc/{pid}/cmdline").read_bytes() != command}


def test_the_only_mission_is_cancelled_while_its_model_compiles(tmp_path):
    with up(tmp_path, "tiger.yaml") as system:
        with stopped_compiler(system):
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
        with stopped_compiler(system):
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
