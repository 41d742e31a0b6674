from pathlib import Path

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.pruning import pruned
from aos_deploy.runs.record import RunRecord

DAY_NS = 86_400 * 10**9


def run_of_day(runs: Path, day: int, *, is_over: bool = True) -> RunDirectory:
    run = RunDirectory.create(runs, "tiger", day * DAY_NS)
    run.write_record(
        RunRecord(robot="tiger", endpoint="", deploy_file="", seed=1, started=f"day {day}", pid=1)
    )
    run.log("solver").write_bytes(bytes(10_000))
    if is_over:
        run.close()
    return run


def names(runs: Path) -> list[str]:
    return sorted(path.name for path in runs.iterdir() if not path.is_symlink())


def test_the_newest_runs_stay_and_the_space_of_the_others_is_told(tmp_path):
    runs = [run_of_day(tmp_path, day) for day in (3, 1, 4, 2)]
    again = run_of_day(tmp_path, 4)  # The second of its second.
    (tmp_path / "notes").mkdir()
    (tmp_path / "19700101T000000Z-notes").mkdir()  # It has no logs: it is no run.
    done = pruned(tmp_path, keep=2)
    assert [Path(run.directory).name[:8] for run in done.removed] == ["19700102", "19700103", "19700104"]
    assert names(tmp_path) == ["19700101T000000Z-notes", runs[2].path.name, again.path.name, "notes"]
    assert all(run.size_bytes >= 10_000 for run in done.removed)
    assert (done.kept, done.freed_bytes) == (2, sum(run.size_bytes for run in done.removed))
    assert RunDirectory.latest(tmp_path).path == again.path


def test_the_latest_run_stays_although_the_clock_was_set_back_before_it(tmp_path):
    for day in (3, 4):
        run_of_day(tmp_path, day)
    latest = run_of_day(tmp_path, 1)
    pruned(tmp_path, keep=1)
    assert names(tmp_path) == [latest.path.name]


def test_a_run_that_goes_on_stays_however_old_it_is(tmp_path):
    old = run_of_day(tmp_path, 1, is_over=False)
    over = run_of_day(tmp_path, 2)
    done = pruned(tmp_path, keep=0)
    assert [run.directory for run in done.removed] == [str(over.path)]
    assert names(tmp_path) == [old.path.name]
    assert not (tmp_path / "latest").is_symlink()  # It named the one that has gone.
    old.close()
    assert pruned(tmp_path, keep=0).kept == 0
    assert names(tmp_path) == []


def test_a_start_that_came_to_nothing_is_removed_with_the_others(tmp_path):
    RunDirectory.create(tmp_path, "tiger", 0).close()
    assert len(pruned(tmp_path, keep=0).removed) == 1
