"""The output of commands where nobody looks at a terminal: their results, and nothing beside them."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from models import built_bundle
from processes import COMMAND_S
from typer.testing import CliRunner

from aos_deploy import cli
from aos_lab.commands import simulate
from aos_solver.mission.simulation import SimulatedRun, simulate_mission

AOS = Path(sys.executable).parent / "aos"
COMMANDS = (
    ("simulate", "--runs", "2", "--simulations", "10"),
    ("plan", "--simulations", "10"),
    ("plan", "--exact", "--horizon", "3"),
    ("solve", "--time", "0.1"),
)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_piped_command_says_nothing_beside_its_result(
    command: tuple[str, ...], bundles: Path, cache_dir: Path
) -> None:
    bundle = bundles / "bench" / "tiger"
    asyncio.run(built_bundle(bundle, cache_dir))
    done = subprocess.run(
        [AOS, command[0], str(bundle), *command[1:], "--json"],
        capture_output=True,
        text=True,
        timeout=COMMAND_S,
        env={**os.environ, "AOS_CACHE_DIR": str(cache_dir)},
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)
    assert done.stderr == ""


def test_ctrl_c_tells_of_the_simulated_missions_that_have_ended(
    bundles: Path, cache_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def third_interrupted(*arguments: Any, **options: Any) -> SimulatedRun:
        if arguments[1].seed == 3:
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.Event().wait()
        return await simulate_mission(*arguments, **options)

    monkeypatch.setenv("AOS_CACHE_DIR", str(cache_dir))
    monkeypatch.setattr(simulate, "simulate_mission", third_interrupted)
    command = ["simulate", str(bundles / "bench" / "tiger"), "--runs", "5", "--simulations", "10", "--json"]
    done = CliRunner().invoke(cli.aos_app(), command)
    assert done.exit_code == 130
    assert [run["seed"] for run in json.loads(done.stdout)["runs"]] == [1, 2]
    assert "stopped after 2 of 5 missions" in done.stderr


def test_ctrl_c_while_a_command_is_imported_is_no_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "import_module", interrupted)
    monkeypatch.setattr(sys, "argv", ["aos", "lint"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 130


def test_an_output_that_cannot_be_written_is_told_in_one_line() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [AOS, "schema", "deploy"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=COMMAND_S
        )
    assert done.returncode == 3
    assert done.stderr == "aos: the output cannot be written: No space left on device\n"
