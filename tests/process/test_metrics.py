import json
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gateway import Gateway, gateway, running, slow_system
from long_run import write_long_run


def samples(served: Gateway) -> dict[str, float]:
    answer = served.ask("/metrics")
    assert (answer.status, answer.headers["content-type"]) == (
        200,
        "text/plain; version=0.0.4; charset=utf-8",
    )
    lines = (line.rpartition(" ") for line in answer.body.decode().splitlines() if line[0] != "#")
    return {name: float(value) for name, _, value in lines}


@contextmanager
def resumed(run: Path) -> Iterator[None]:
    with running(run.parents[1], "aos-up", "--resume", run, "--json") as process:
        assert process.stdout is not None
        next(line for line in process.stdout if json.loads(line)["event"] == "decision")
        yield


def test_a_mission_is_counted_while_it_runs_and_when_it_ends(tmp_path):
    write_long_run(tmp_path / "runs", 2)
    with gateway(tmp_path) as served:
        assert served.ask("/metrics").status == 404
    with gateway(tmp_path, "--metrics") as served, slow_system(tmp_path) as run:
        assert served.ask("/metrics", has_token=False).status == 401
        begun = samples(served)
        assert not [name for name in begun if "marathon" in name]  # It counts nothing of before.
        assert begun['aos_missions_running{robot="tiger"}'] == 1
        assert begun['aos_decision_seconds_count{robot="tiger",chosen_by="planner"}'] == 1
        assert begun['aos_simulations_total{robot="tiger"}'] == 100
        assert 'aos_steps_total{robot="tiger"}' not in begun
        with served.events(f"/v1/events?mission={run.name}") as events:
            served.post(f"/v1/missions/{run.name}/steering", {"verb": "hold", "by": "ada"})
            (tmp_path / "turns").write_bytes(b".")
            next(data for _, kind, data in events if kind == "state" and data["phase"] == "holding")
            held = samples(served)
            assert held['aos_holds_total{robot="tiger",held_for="operator"}'] == 1
            assert held['aos_missions_holding{robot="tiger"}'] == 1
            assert (
                held['aos_steps_total{robot="tiger"}'] == held['aos_surprise_nats_count{robot="tiger"}'] == 1
            )
            assert held[f'aos_goal_probability{{robot="tiger",mission="{run.name}"}}'] < 1
            os.kill(json.loads((run / "run.json").read_text())["pids"]["solver"], signal.SIGKILL)
            next(data for _, kind, data in events if kind == "state" and data.get("epoch") == 2)
        again = samples(served)
        assert again['aos_service_restarts_total{robot="tiger",service="solver"}'] == 1
        assert again['aos_holds_total{robot="tiger",held_for="operator"}'] == 1
        served.post(f"/v1/missions/{run.name}/stop")
        over = samples(served)
        assert over['aos_missions_total{robot="tiger",ending="cancelled"}'] == 1
        assert 'aos_missions_running{robot="tiger"}' not in over


def test_a_run_that_was_killed_and_taken_up_is_counted_once_also_by_who_was_not_asked_meanwhile(tmp_path):
    running, killed, cancelled = (
        f"aos_missions_{what}}}"
        for what in (
            'running{robot="tiger"',
            'total{robot="tiger",ending="killed"',
            'total{robot="tiger",ending="cancelled"',
        )
    )
    with (
        slow_system(tmp_path) as run,
        gateway(tmp_path, "--metrics") as served,
        gateway(tmp_path, "--metrics") as asked,
    ):
        assert samples(asked)[running] == samples(served)[running] == 1
        os.kill(json.loads((run / "run.json").read_text())["pid"], signal.SIGKILL)
        while served.ask(f"/v1/runs/{run.name}").json["is_running"]:
            pass
        for one in (served, asked):
            assert samples(one)[killed] == 1
            assert running not in samples(one)
        with gateway(tmp_path, "--metrics") as later:
            assert killed not in samples(later)
            with resumed(run):
                assert asked.ask(f"/v1/runs/{run.name}").json["is_running"] is True
                assert samples(asked)[running] == 1
            assert served.ask(f"/v1/runs/{run.name}").json["ending"] == "cancelled"
            for one, kills in ((served, 1), (asked, 1), (later, None)):
                now = samples(one)
                assert (now.get(killed), now.get(cancelled), now.get(running)) == (kills, 1, None)
