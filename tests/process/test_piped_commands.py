import asyncio
import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from models import built_bundle
from places import BUNDLES
from processes import COMMAND_S, finished

from aos_solver.offline.solving import build_solver

AOS = Path(sys.executable).parent / "aos"
COMMANDS = (
    ("simulate", "--runs", "2", "--simulations", "10"),
    ("plan", "--simulations", "10"),
    ("plan", "--exact", "--horizon", "3"),
    ("solve", "--time", "0.1"),
)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_piped_command_says_nothing_beside_its_result(command, cache_dir: Path):
    bundle = BUNDLES / "bench" / "tiger"
    asyncio.run(built_bundle(bundle))
    asyncio.run(build_solver(cache_dir))
    done = finished(AOS, command[0], str(bundle), *command[1:], "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)
    assert done.stderr == ""


def test_an_output_that_cannot_be_written_is_told_in_one_line():
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [AOS, "schema", "deploy"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=COMMAND_S
        )
    assert done.returncode == 3
    assert done.stderr == "aos: the output cannot be written: No space left on device\n"


@pytest.mark.parametrize("command", [("schema", "deploy"), ("doctor",)])
def test_a_command_whose_reader_has_gone_ends_without_a_word(command):
    with subprocess.Popen([AOS, *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as done:
        assert done.stdout is not None
        done.stdout.close()
        _, said = done.communicate(timeout=COMMAND_S)
    assert (done.returncode, said) == (-signal.SIGPIPE, b"")


def test_a_folder_that_cannot_be_used_is_told_in_one_line(tmp_path):
    (tmp_path / "file").touch()
    command = [AOS, "experiment", "run", "armadillo", "--out", tmp_path / "file" / "out"]
    done = finished(*command)
    assert done.returncode == 3
    assert done.stderr == f"aos: {tmp_path}/file/out cannot be used: Not a directory\n"


@pytest.mark.parametrize(
    "command", [("calibrate", ".", ".", "--write"), ("test", "missions.yaml", "--junit")]
)
def test_a_file_in_no_folder_is_told_before_the_work_begins(command, tmp_path):
    target = tmp_path / "none" / "it.pomdp"
    done = finished(AOS, *command, target)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"Invalid value for '{command[-1]}': there is no folder {target.parent}" in done.stderr


def test_an_experiment_of_no_missions_is_refused():
    command = [AOS, "experiment", "run", "armadillo", "--seeds", "0"]
    done = finished(*command)
    assert done.returncode == 2
    assert "no missions: give --seeds or --system-seeds" in done.stderr
