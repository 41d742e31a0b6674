import asyncio
import json
import subprocess
import sys
import time
from pathlib import Path

import pytest
from places import ROOT
from processes import finished, kill
from test_missions import up

from aos_deploy.history_check.files import check_run
from aos_protocol.access import OPERATOR
from aos_protocol.errors import SteeringError
from aos_runtime.client import AosClient
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import mission_folder


def followed(run: Path) -> subprocess.CompletedProcess[str]:
    example = [sys.executable, ROOT / "docs/examples/follow_decisions.py", run]
    return finished(*example)


async def test_an_operator_steers_a_mission_by_commands_and_after_a_kill_it_is_steered_as_before(tmp_path):
    with up(tmp_path) as system:
        system.be_slow(True)
        name = system.until("mission", phase="acting")["mission"]
        code, said, _ = system.aos("mission", "hold")
        assert (code, said.count("holds it after step 1, which is under way: listen")) == (0, 1)
        system.be_slow(False)
        system.until("mission", phase="holding", step=1)
        assert system.aos("mission", "leave-out", "open(door=left_door)")[0] == 0
        kill(system.record["pids"]["solver"])
        system.until("service", service="solver", state="ready")
        held = system.until("mission", phase="holding", step=1)
        assert held["left_out"].keys() == {"open(door=left_door)"}
        assert system.aos("mission", "list")[1].endswith("holds the mission\n")

        code, _, error = system.aos("mission", "do", "open(door=left_door)")
        assert code == 3
        assert "AOS518: open(door=left_door) is refused: open(door=left_door) is left out by" in error
        code, _, error = system.aos("mission", "do", "open(door=left_dor)")
        assert "AOS517: there is no action open(door=left_dor). Did you mean `open(door=left_door)`?" in error
        assert (
            system.aos("mission", "do", "open(door=right_door)")[1]
            == f"{name}: step 2: open(door=right_door)\n"
        )
        (tmp_path / "actions.txt").write_text("# once more\nlisten\n")
        assert "none.txt cannot be read: No such" in system.aos("mission", "script", "none.txt")[2]
        assert system.aos("mission", "script", "actions.txt")[1] == f"{name}: 1 action asked for\n"
        assert system.until("mission", phase="ended")["ending"] == "step_limit"
        code, _, error = system.aos("mission", "hold")
        assert "AOS517: no mission runs" in error
        told = followed(system.run).stdout
        assert "\nstep 2: operator chose open(door=right_door)\n" in told
        assert "\nstep 3: observed " in told
        assert system.interrupt() == 0
        over = followed(system.run)
        assert (over.returncode, over.stderr[:3]) == (1, "AOS")
        assert check_run(system.run).violations == []
        with Journal.read(mission_folder(system.run, 1) / "journal.db") as journal:
            decisions = [json.loads(row.payload) for row in journal.walk("decision")]
            rows = [json.loads(row.payload) for row in journal.walk("steered")]
        chosen = {record["step"]: record.get("chosen_by", "planner") for record in decisions}
        assert chosen == {1: "planner", 2: "operator", 3: "script"}
        assert [row["verb"] for row in rows] == ["hold", "leave_out", "act", "act", "script"]
        assert len({row["by"] for row in rows}) == 1


async def test_a_program_steers_and_stop_cancels_motion_at_once(tmp_path):
    with up(tmp_path) as system:
        system.be_slow(True)
        system.until("mission", phase="acting")
        async with AosClient.of_run(system.run, OPERATOR, by="ana") as aos:
            asked = asyncio.create_task(aos.act("open(door=left_door)"))
            while not (await aos.mission_state()).asked:
                pass
            begun_s = time.monotonic()
            state = await aos.stop_mission()
            took_s = time.monotonic() - begun_s
            assert (state.ending, state.remark) == ("cancelled", "stopped by hand")
            print(f"stopped after {took_s:.3f} s")
            with pytest.raises(SteeringError, match="the mission has ended before: cancelled"):
                await asked
        assert system.interrupt() == 0
        assert check_run(system.run).violations == []
