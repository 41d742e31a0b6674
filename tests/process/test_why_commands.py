import json
import shutil
from pathlib import Path

from commands import aos
from places import BUNDLES
from test_missions import up

LINES = 8


def test_a_mission_that_runs_is_explained_as_afterwards_and_goes_on(tmp_path):
    with up(tmp_path, "tiger.yaml") as system:
        system.be_slow(True)
        system.until("mission", phase="acting")
        code, out, error = system.aos("why", "1", "--json")
        assert code == 0, error
        live = json.loads(out)
        assert live["action"] == "listen"
        assert {each["response"] for each in live["expected"]} == {"tiger_left", "tiger_right"}
        code, out, error = system.aos("whatif", "1", "--change", "open.sd:8:54=12")
        assert code == 2
        assert "AOS530: open.sd:8 has no number there" in error
        code, out, error = system.aos("whatif", "1", "--forbid", "listen")
        assert code == 0, error
        assert out.splitlines()[0].startswith("step 1: open(door=")
        system.be_slow(False)
        assert system.ended() == 6
        run = system.run

        after = json.loads(system.aos("why", "1", "--json")[1])
        for each in after["expected"]:
            each.pop("is_seen", None)
        # The outcome is later than the first question.
        assert after.pop("update_s") > 0 == live.pop("update_s")
        assert after.pop("update_effort").endswith("steps of the model")
        assert "update_effort" not in live
        for lines in ("terms", "rest", "other_rest", "remark"):  # The solver may still compile for these.
            after.pop(lines, None)
            live.pop(lines, None)
        assert after == live
        second = json.loads(system.aos("why", "2", "--json")[1])
        assert [each.get("is_seen", False) for each in second["expected"]].count(True) == 1
        text = system.aos("why", "2")[1]
        assert len(text.splitlines()) <= LINES
        assert text.startswith("step 2: ")
        assert system.aos("why")[1].startswith("step 3: ")
        assert "AOS501: there is no action run" in system.aos("why", "1", "--instead", "run")[2]

        code, out, error = system.aos("replay", str(run))
        assert code == 0, error
        assert "3 of 3 decisions identical in action, values and counts; 6 beliefs identical" in out
        assert json.loads(system.aos("replay", "--until", "2", "--json")[1])["decisions"] == 2
        beyond = system.aos("replay", "--until", "99")[2]
        assert "--until 99 is after the last decision, of step 3" in beyond
        assert system.aos("diff", str(run), str(run))[0] == 0
        kept = json.loads((run / "deploy.json").read_text())
        assert Path(kept["bundles"][0]).is_absolute()
        assert system.record["version"]

        other = shutil.copytree(run, run.with_name("other"))
        settings = json.loads((other / "settings" / "solver.json").read_text())
        settings["simulations"] = 100
        (other / "settings" / "solver.json").write_text(json.dumps(settings))
        code, out, _ = system.aos("replay", str(other))
        assert code == 1
        assert "step 1 differs, at its decision, listen" in out
        assert "the search had (200,) simulations, and (100,) in the replay" in out
        code, out, _ = system.aos("diff", str(run), str(other))
        assert "simulations: 200 in A, 100 in B" in out


def test_a_plan_may_begin_with_another_belief(tmp_path):
    bundle, supposed = BUNDLES / "bench" / "tiger", tmp_path / "belief.txt"
    supposed.write_text("tiger_behind=Left:0.999\n")
    for belief in ("tiger_behind=Left:0.999", supposed):
        done = aos("plan", bundle, "--belief", belief, "--json")
        assert done.exit_code == 0, done.output
        assert json.loads(done.stdout)["action"] == "open(door=right_door)"
        assert "supposed tiger_behind=Left: 0.999 instead of 0.5" in done.stderr
    unknown = aos("plan", bundle, "--belief", "lion=Left:1")
    assert "AOS501: there is no variable lion" in str(unknown.exception)
