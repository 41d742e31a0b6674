import asyncio
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from commands import aos
from places import BUNDLES, DEPLOY
from processes import HANG_S
from test_mission_tests import MISSIONS

from aos_lab.calibration import calibrate as calibration
from aos_lab.calibration import records
from aos_lab.calibration.records import RecordedMission
from aos_lab.commands import simulate
from aos_lab.trials.players import ModelPlayer
from aos_lab.trials.trial import Trial
from aos_solver.mission.simulation import SimulatedRun, simulate_mission


def test_ctrl_c_tells_of_the_simulated_missions_that_have_ended(monkeypatch):
    async def third_interrupted(*arguments: Any, **options: Any) -> SimulatedRun:
        if arguments[1].seed == 3:
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.Event().wait()
        return await simulate_mission(*arguments, **options)

    monkeypatch.setattr(simulate, "simulate_mission", third_interrupted)
    command = ["simulate", str(BUNDLES / "bench" / "tiger"), "--runs", "5", "--simulations", "10", "--json"]
    done = aos(*command)
    assert done.exit_code == 130
    assert [run["seed"] for run in json.loads(done.stdout)["runs"]] == [1, 2]
    assert "stopped after 2 of 5 missions" in done.stderr


@pytest.mark.parametrize("program", ["aos", "aos-up"])
def test_ctrl_c_before_a_command_is_known_is_no_traceback(tmp_path, program):
    (tmp_path / "typer.py").write_text("import sys\nprint('imports', flush=True)\nsys.stdin.read()\n")
    with subprocess.Popen(
        [Path(sys.executable).parent / program, "--help"],
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as command:
        assert command.stdout is not None
        assert command.stdout.readline() == "imports\n"
        command.send_signal(signal.SIGINT)
        _, said = command.communicate(timeout=HANG_S)
    assert (command.returncode, said) == (-signal.SIGINT, "")


@pytest.mark.parametrize("keeps", [False, True], ids=["passing", "kept"])
def test_ctrl_c_tells_after_how_many_missions_of_a_test(tmp_path, monkeypatch, keeps):
    play = ModelPlayer.play

    async def third_interrupted(player: ModelPlayer, seed: int) -> Trial:
        if seed == 3:
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.Event().wait()
        return await play(player, seed)

    monkeypatch.setattr(ModelPlayer, "play", third_interrupted)
    file = tmp_path / "missions.yaml"
    file.write_text(MISSIONS.replace("seeds: 2", "seeds: 5"))
    command = ["test", str(file), *(["--keep", str(tmp_path / "kept")] if keeps else [])]
    done = aos(*command)
    assert done.exit_code == 130
    after = "the same command goes on" if keeps else "with --keep DIR the same command would go on"
    assert done.stderr == f"aos: stopped in finer after 2 of its 5 missions; {after} from there\n"


def test_ctrl_c_ends_a_calibration_while_it_computes(tmp_path, monkeypatch):
    has_gone_on = False

    def interrupted(*arguments: Any) -> tuple[()]:
        nonlocal has_gone_on
        os.kill(os.getpid(), signal.SIGINT)
        has_gone_on = True
        return ()

    monkeypatch.setattr(records, "read_missions", lambda path: [RecordedMission("run", ())])
    monkeypatch.setattr(calibration, "estimate", interrupted)
    bundle = DEPLOY / "bundles" / "armadillo-finer"
    done = aos("calibrate", tmp_path, bundle)
    assert (done.exit_code, done.stderr) == (130, "aos: stopped; nothing was estimated\n")
    assert not has_gone_on
