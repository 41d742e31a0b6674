import os
from pathlib import Path

import pytest
from commands import aos

from aos_deploy.commands.runs import Entry, print_entries
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import RUNS, chosen_run, living_run, living_runs, noted, runs_here
from aos_deploy.runs.record import RunRecord
from aos_protocol.errors import BusError


def run_in(folder: Path) -> Path:
    run = RunDirectory.create(folder, "r", 0)
    run.write_record(RunRecord(robot="r", endpoint="", deploy_file="", seed=1, started="", pid=1))
    run.close()
    return run.path


def test_the_runs_of_a_deploy_file_in_a_folder_are_found_from_above(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BusError, match="there is no run in runs"):
        chosen_run(None, None)
    below = run_in(tmp_path / "deploy" / "runs")
    assert chosen_run(None, None).path == below
    # Of two folders nobody knows which one is meant.
    run_in(tmp_path / "lab" / "runs")
    assert runs_here() == RUNS
    here = run_in(tmp_path / "runs")
    assert chosen_run(None, None).path == here


def test_a_command_says_which_run_of_another_folder_it_is_for(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("AOS_RUNNING_DIR", str(tmp_path / "running"))
    run = RunDirectory.create(tmp_path / "here" / "runs", "r", 0)
    run.write_record(RunRecord(robot="r", endpoint="", deploy_file="", seed=1, started="", pid=os.getpid()))
    with noted(run):
        for folder in (tmp_path / "here", tmp_path, tmp_path / "running"):
            monkeypatch.chdir(folder)
            assert chosen_run(None, None).path == living_run(None, None).path
    run.close()
    assert capsys.readouterr().err == f"aos: the run is {run.path}\n" * 2


def test_what_is_checked_is_the_last_run_here_also_while_another_runs(tmp_path, monkeypatch):
    monkeypatch.setenv("AOS_RUNNING_DIR", str(tmp_path / "running"))
    run_in(tmp_path / "runs")
    monkeypatch.chdir(tmp_path)
    other = RunDirectory.create(tmp_path / "other", "r", 0)
    other.write_record(RunRecord(robot="r", endpoint="", deploy_file="", seed=1, started="", pid=os.getpid()))
    with noted(other):
        output = aos("check").output
    other.close()
    assert "\nruns/19700101T000000Z-r: 1 violation of rows" in output


def test_a_run_that_was_killed_and_taken_up_is_one(tmp_path, monkeypatch):
    monkeypatch.setenv("AOS_RUNNING_DIR", str(tmp_path / "running"))
    run = RunDirectory.create(tmp_path / "runs", "r", 0)
    record = RunRecord(robot="r", endpoint="", deploy_file="", seed=1, started="", pid=os.getpid())
    run.write_record(record)
    with noted(run):
        (tmp_path / "running" / f"{run.path.name}-1").symlink_to(run.path)  # by the aos-up that was killed
        assert [each.path for each in living_runs()] == [run.path]
    run.close()


def test_of_a_system_with_many_missions_the_newest_are_listed_and_the_others_counted(capsys):
    endings = ["goal"] * 187 + ["failure"] * 2 + ["goal"] * 10
    missions = tuple(Entry(f"missions/{n}", "r", "", each, 3, 1.0, "") for n, each in enumerate(endings, 1))
    print_entries([Entry("runs/1", "r", "", "waiting", None, None, "", missions)])
    system, earlier, *newest = capsys.readouterr().out.splitlines()
    assert system.split() == ["waiting", "r", "runs/1"]
    assert earlier == "  189 earlier missions: 187 goal, 2 failure. `aos runs --json` lists each"
    assert [line.split()[-1] for line in newest] == [f"missions/{n}" for n in range(190, 200)]
