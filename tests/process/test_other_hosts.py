import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from commands import aos
from places import BIN
from processes import finished
from ssh_host import refusing_ssh, slow_stand_in, ssh_server, stand_in

FIRST_TIME_BAD = "test -e tried || { touch tried; exit 3; }; exec python3 fetch_robot.py"


@pytest.fixture(autouse=True)
def project(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    aos("new", "project", "fetch")
    aos("new", "adapter", "command", "--in", "fetch")
    # The Python of the other host is the one that has Zenoh.
    monkeypatch.setenv("PATH", f"{BIN}{os.pathsep}{os.environ['PATH']}")


@pytest.fixture
def ssh(tmp_path) -> Iterator[str]:
    """The folder of an `ssh` that reaches robot@arm.

    It is the real one where OpenSSH's server is there and may be started, by root alone; else a stand-in.
    """
    if shutil.which("sshd", path="/usr/sbin") and shutil.which("ssh") and os.getuid() == 0:
        with ssh_server(tmp_path) as folder:
            yield folder
    else:
        yield stand_in(tmp_path)


def up(ssh: str, command: str, folder: Path) -> tuple[int, str]:
    """Plays a mission with this program on the other host; returns how it ends, and what is said."""
    text = Path("fetch.yaml").read_text()
    before, _, after = text.partition("{command:")
    adapter = f"{{command: {command}, host: robot@arm, folder: {folder}}}"
    Path("fetch.yaml").write_text(before + adapter + after.partition("}")[2])
    done = finished(
        BIN / "aos-up",
        "fetch.yaml",
        "--plain",
        "--listen",
        "tcp/127.0.0.1:0",
        env={**os.environ, "PATH": f"{ssh}{os.pathsep}{os.environ['PATH']}"},
    )
    return done.returncode, done.stdout + done.stderr


def left_behind(folder: Path) -> list[str]:
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (process / "cwd").readlink() == folder:
                found.append((process / "cmdline").read_bytes().replace(b"\0", b" ").decode())
        except OSError:
            continue
    return [command for command in found if "fetch_robot" in command or "sleep 1000" in command]


def test_our_services_may_be_ready_before_it_is_known_how_to_dial_the_other_host(tmp_path):
    status, said = up(slow_stand_in(tmp_path), f"[{sys.executable}, fetch_robot.py]", tmp_path)
    assert status == 0, said


def test_a_program_that_ends_over_there_is_started_again(tmp_path):
    script = FIRST_TIME_BAD.replace("python3", sys.executable)
    status, said = up(stand_in(tmp_path), f'[sh, -c, "{script}"]', tmp_path)
    assert status == 0, said
    assert "robot starting: start 2" in said


def test_a_program_that_the_other_host_does_not_have_is_named(ssh: str, tmp_path):
    status, said = up(ssh, "[arm_driver]", tmp_path)
    assert status == 3
    assert f"robot on robot@arm: there is no program arm_driver in {tmp_path} or on the PATH" in said


def test_a_host_that_is_not_reached_ends_the_start(tmp_path):
    text = "ssh: connect to host arm port 22: Connection refused"
    status, said = up(refusing_ssh(tmp_path, text), "[arm_driver]", tmp_path)
    assert status == 3
    assert f"robot@arm cannot be reached by ssh: {text}" in said
    assert "See that it works by hand, without a password: ssh robot@arm true" in said


def test_programs_on_another_host_run_a_mission_are_ready_by_what_they_print_and_end_with_the_run(
    ssh: str, tmp_path
):
    (tmp_path / "fetch_robot_sim.sh").write_text("echo over there is $AOS_ROBOT; sleep 1000 & wait\n")
    with Path("fetch.yaml").open("a") as deploy:
        deploy.write(
            f"programs:\n  sim: {{command: [sh, fetch_robot_sim.sh], host: robot@arm, folder: {tmp_path},"
            " ready: {line: over there is fetch}}\n"
        )
    status, said = up(ssh, f"[{sys.executable}, fetch_robot.py]", tmp_path)
    assert status == 0, said
    assert "mission ended: the goal is reached" in said
    assert said.index("sim ready") < said.index("robot starting")
    assert left_behind(tmp_path) == []
