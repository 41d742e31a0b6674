import asyncio
import contextlib
import json
import os
import pty
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from commands import aos
from places import BIN
from processes import COMMAND_S, HANG_S, descendants, finished, kill
from supervised_system import System, command, small

from aos_deploy.deployment.own_programs import ReadyPart
from aos_deploy.processes.program import Program
from aos_protocol.errors import AosError

SERVES_A_PORT = """
import socket, sys, time
with socket.create_server(("127.0.0.1", int(sys.argv[1]))) as server:
    while True:
        server.accept()[0].close()
"""
ADAPTER = command("python", "small_command.py")


def own(
    *words: str, name: str = "nav", ready: ReadyPart | None = None, folder: Path | None = None, **more: Any
) -> Program:
    values: dict[str, Any] = {"on_exit": "fault", "start_s": HANG_S, **more}
    where = str(folder) if folder is not None else None
    return Program(name=name, command=words, ready=ready, folder=where, **values)


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


async def test_the_adapters_start_when_the_programs_are_ready_and_stop_before_them(system: System):
    script = "read line <go; echo navigation is up; sleep 1000"
    nav = own("sh", "-c", script, folder=system.folder, ready=ReadyPart(line="^nav.* up$"))
    os.mkfifo(system.folder / "go")
    skills = small("skills", is_adapter=True)
    async with asyncio.timeout(HANG_S), system.up(small("registry"), nav, ADAPTER, skills):
        await system.until("registry", "ready")
        await system.until("nav", "starting")
        assert {"robot", "skills"}.isdisjoint(system.order("starting"))
        await asyncio.to_thread((system.folder / "go").write_text, "go\n")
        await system.until("robot", "ready")
        await system.until("skills", "ready")
    assert system.order("ready").index("nav") < system.order("ready").index("robot")
    assert system.order("starting")[0] == "router"
    told = [(event.service, event.state) for event in system.events]
    assert told.index(("router", "ready")) < told.index(("nav", "starting"))
    assert system.order("starting").count("robot") == 1
    stopping = system.order("stopping")
    assert stopping.index("robot") < stopping.index("nav") < stopping.index("registry")
    assert "navigation is up" in system.run.log("nav").read_text()


async def test_programs_are_seen_to_be_ready_each_by_its_sign(system: System):
    port = free_port()
    kinds: dict[str, tuple[list[str], ReadyPart | None]] = {
        "port": ([sys.executable, "-c", SERVES_A_PORT, str(port)], ReadyPart(port=port)),
        "line": (["sh", "-c", "echo is it; echo it is up; sleep 1000"], ReadyPart(line="^it is [a-z]+$")),
        "file": (["sh", "-c", "echo $$ >pid; sleep 1000"], ReadyPart(file="pid")),
        "command": (["sh", "-c", "touch there; sleep 1000"], ReadyPart(command=("test", "-e", "there"))),
        "seconds": (["sleep", "1000"], ReadyPart(seconds=0.2)),
        "nothing": (["sleep", "1000"], None),
    }
    old = system.folder / "pid"  # of an earlier run
    old.touch()
    os.utime(old, (0, 0))
    programs = [
        own(*words, name=kind, ready=ready, folder=system.folder) for kind, (words, ready) in kinds.items()
    ]
    async with asyncio.timeout(HANG_S), system.up(*programs):
        for kind in kinds:
            await system.until(kind, "ready")
    # Each waits for the one before it.
    changes = [(event.service, event.state) for event in system.events]
    for before, after in pairwise(kinds):
        assert changes.index((before, "ready")) < changes.index((after, "starting"))


async def test_a_set_up_program_ends_before_the_adapters_start(system: System):
    setup = own("sh", "-c", "echo homed", name="homing", ready=ReadyPart(exit=0))
    async with asyncio.timeout(HANG_S), system.up(setup, ADAPTER):
        await system.until("robot", "ready")
    changes = [(event.service, event.state) for event in system.events]
    assert changes.index(("homing", "done")) < changes.index(("robot", "starting"))
    assert system.ends == []


async def failing(system: System, *programs: Program) -> AosError:
    error = await system.error(*programs)
    assert "robot" not in system.order("starting")
    return error


async def test_a_set_up_program_that_fails_ends_the_run(system: System):
    setup = own("sh", "-c", "echo no motor; exit 3", name="homing", ready=ReadyPart(exit=0))
    error = await failing(system, setup, ADAPTER)
    assert (error.code, error.message) == ("AOS802", "homing ended with exit status 3, and is to end with 0")
    assert "no motor" in error.hint


async def test_a_program_that_is_not_ready_in_time_is_told_with_what_was_awaited(system: System):
    nav = own("sh", "-c", "echo waiting for the map; sleep 1000", ready=ReadyPart(line="up"), start_s=0.5)
    error = await failing(system, nav, ADAPTER)
    assert error.code == "AOS802"
    assert error.message == "nav was not ready within 0.5 s: it has printed no line that matches up"
    assert "waiting for the map" in error.hint


async def test_a_port_that_somebody_else_serves_is_told(system: System):
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        error = await failing(system, own("sleep", "1000", ready=ReadyPart(port=port)), ADAPTER)
    assert error.message == f"nav is to serve localhost:{port}, where something listens before it is started"
    assert "an earlier run" in error.hint


async def test_a_program_that_goes_into_the_background_is_told_to_stay(system: System):
    error = await failing(system, own("sh", "-c", "sleep 1000 &", ready=ReadyPart(line="up")), ADAPTER)
    assert error.message == "nav ended unexpectedly: exit status 0"
    assert "keep it in the foreground" in error.hint


@pytest.mark.parametrize(
    ("on_exit", "then"),
    [("fault", "the run ends"), ("restart", "it is started again"), ("ignore", "ignored")],
)
async def test_what_follows_the_end_of_a_program_is_said_in_the_deploy_file(system: System, on_exit, then):
    endless = ("sh", "-c", "echo up; sleep 1000")
    nav = own(*endless, ready=ReadyPart(line="up"), on_exit=on_exit, is_restarted=on_exit == "restart")

    async def work():
        async with asyncio.timeout(HANG_S), system.up(nav, ADAPTER) as supervisor:
            await system.until("robot", "ready")
            kill(descendants(supervisor.pids["nav"])[0])
            await system.until("nav", "ended")
            if on_exit == "fault":
                await asyncio.Event().wait()
            if on_exit == "restart":
                await system.until("nav", "ready", times=2)

    if on_exit == "fault":
        with pytest.raises(AosError, match="nav ended unexpectedly: killed by SIGKILL") as raised:
            await work()
        assert raised.value.code == "AOS804"
    else:
        await work()
    (end,) = system.ends
    assert (end.name, end.how, end.then) == ("nav", "killed by SIGKILL", then)
    detail = next(event.detail for event in system.events if (event.service, event.state) == ("nav", "ended"))
    assert detail == f"killed by SIGKILL; {then}"


PUTS_DOWN = """
import signal, time
def end(*_):
    time.sleep(1)
    print("put down")
    raise SystemExit
signal.signal(signal.SIGTERM, end)
print("up")
while True:
    time.sleep(0.1)
"""


async def test_a_program_that_catches_sigterm_has_its_time_to_end(system: System):
    nav = own(sys.executable, "-c", PUTS_DOWN, ready=ReadyPart(line="up"), stop_s=HANG_S)
    async with asyncio.timeout(HANG_S), system.up(nav):
        await system.until("nav", "ready")
    assert "put down" in system.run.log("nav").read_text()


# --- whole missions ---

PROGRAMS = """programs:
  sim: {command: [python, sim.py], ready: {line: listening}}
"""


@pytest.fixture(scope="module")
def template(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("template")
    with contextlib.chdir(folder):
        aos("new", "project", "fetch")
        aos("new", "adapter", "command", "--in", "fetch")
    (folder / "sim.py").write_text(SIMULATOR)
    robot = folder / "fetch_robot.py"
    robot.write_text(
        'import socket\nsim = socket.create_connection(("127.0.0.1", int(open("port").read())))\n'
        + robot.read_text()
    )
    deploy = folder / "fetch.yaml"
    deploy.write_text(deploy.read_text() + PROGRAMS)
    return folder


@pytest.fixture
def project(template: Path, tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(template, tmp_path, dirs_exist_ok=True)
    return tmp_path


SIMULATOR = """
import socket, threading
with socket.create_server(("127.0.0.1", 0)) as server:
    with open("port", "w") as port:
        port.write(str(server.getsockname()[1]))
    print("listening", flush=True)
    robot, _ = server.accept()
    threading.Event().wait()
"""


def up(*options: str) -> subprocess.CompletedProcess[str]:
    words = [BIN / "aos-up", "fetch.yaml", "--plain", "--listen", "tcp/127.0.0.1:0", *options]
    return finished(*words)


KILLS_THE_MIDDLEWARE = """    CAME.acquire()
    if not os.path.exists("killed"):
        open("killed", "x").close()
        os.kill(json.load(open("runs/latest/run.json"))["pids"]["middleware"], signal.SIGKILL)
        CAME.acquire()  # The call comes again.
    for share"""


def test_a_robot_finds_its_simulator_and_joins_a_call_that_comes_again_from_a_new_middleware(project: Path):
    robot = project / "fetch_robot.py"
    text = robot.read_text().replace("    for share", KILLS_THE_MIDDLEWARE)
    text = text.replace("def run(", "CAME = threading.Semaphore(0)\ndef run(")
    robot.write_text(text.replace("first = Future()", "first = Future(); CAME.release()"))
    done = up()
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.index("sim ready") < done.stdout.index("robot starting")
    assert "listening" in Path("runs/latest/logs/sim.log").read_text()
    assert set(json.loads(Path("runs/latest/run.json").read_text())["pids"]) >= {"sim", "robot", "solver"}
    assert "middleware ended: killed by SIGKILL" in done.stdout
    assert "refused" not in done.stdout


LEAVES_AND_COMES = """    LOOKS.append(path)
    if len(LOOKS) == 1:
        declared[-1].undeclare()
        open("told").close()
    elif len(LOOKS) == 2:
        open("back").close()
        declared[-1] = session.liveliness().declare_token(token)
        open("on").close()
    for share"""


def test_a_skill_that_leaves_in_mid_mission_and_comes_again_is_told_once_each(project: Path):
    for name, old, new in (
        ("fetch_robot.py", "    for share", LEAVES_AND_COMES),
        ("fetch_robot.py", "def run(", "LOOKS = []\ndef run("),
        ("fetch/look.am", "max_duration: 10", "max_duration: 1000"),
    ):
        (project / name).write_text((project / name).read_text().replace(old, new))
    for sign in ("told", "back", "on"):
        os.mkfifo(sign)
    up = ["timeout", str(COMMAND_S), BIN / "aos-up", "fetch.yaml", "--plain", "--listen", "tcp/127.0.0.1:0"]
    away = "no adapter answers calls of /take"
    said = ""
    with ExitStack() as given, subprocess.Popen(up, stdout=subprocess.PIPE, text=True) as running:

        def give(sign: str):
            given.callback(os.close, os.open(sign, os.O_RDWR))  # The robot opens it now, or later.

        assert running.stdout is not None
        for line in running.stdout:
            said += line
            if line.startswith(f"cannot be run any more: take: {away} ("):
                give("told")
            elif line.startswith("step  2: look  ["):
                os.kill(json.loads(Path("runs/latest/run.json").read_text())["pids"]["middleware"], 9)
            elif "middleware ready" in line and said.count("middleware ready") == 2:
                give("back")
            elif line == "can be run again: take\n":
                give("on")
    assert running.returncode == 0, said
    assert (said.count("cannot be run"), said.count("can be run again")) == (1, 1), said
    for words, told in ((["decisions"], f"barred: {away}"), (["why", "2"], f"left to choose: {away}")):
        done = aos(*words)
        assert told in f"{done.output}{done.exception}"


def test_a_program_that_does_not_stop_is_not_said_to_stand_still(project: Path):
    robot = project / "fetch_robot.py"
    robot.write_text(robot.read_text().replace("    for share", "    time.sleep(1000)\n    for share"))
    deploy = project / "fetch.yaml"
    rule = "skills: {look: {timeout_s: 1, on_failure: end, retries: 1}}\n"
    deploy.write_text(deploy.read_text() + rule)
    done = up()
    assert done.returncode == 9, done.stdout + done.stderr
    assert "/look may still be moving: it does not say that it has stopped (the robot still" in done.stdout


def test_without_an_output_a_mission_runs_and_nothing_beside_a_robot_that_documents_play(project: Path):
    words = ["sh", "-c", 'exec "$@" >&-', "sh", BIN / "aos-up", "fetch.yaml", "--model"]
    done = finished(*words)
    assert done.returncode == 0, done.stderr
    pids = json.loads(Path("runs/latest/run.json").read_text())["pids"]
    assert "solver" in pids
    assert "sim" not in pids
    assert not (project / "port").exists()


def test_a_closed_terminal_ends_the_mission_in_order(project: Path):
    robot = project / "fetch_robot.py"
    waits = '    open("moves", "x").close()\n    STOP.wait()\n    for share'
    robot.write_text(robot.read_text().replace("    for share", waits))
    terminal, inside = pty.openpty()
    with subprocess.Popen([BIN / "aos-up", "fetch.yaml"], stdout=inside, stderr=subprocess.PIPE) as running:
        os.close(inside)
        while not (project / "moves").exists():
            os.read(terminal, 65536)
        os.close(terminal)
        running.send_signal(signal.SIGHUP)
        _, said = running.communicate(timeout=COMMAND_S)
    assert (running.returncode, said) == (130, b"")
    assert json.loads(Path("runs/latest/summary.json").read_text())["ending"] == "cancelled"


def test_on_a_full_disk_not_everything_is_said_to_be_kept(project: Path, monkeypatch):
    monkeypatch.setenv("AOS_FAILPOINT", "journal.decision.before:full:1")
    done = up("--model")
    assert done.returncode == 3, done.stdout + done.stderr
    assert "; what could be written is in runs/" in done.stdout
    assert "AOS701" in done.stderr


def test_documents_that_cannot_be_played_are_told_at_once(project: Path):
    document = project / "fetch" / "fetch.ef"
    document.write_text(
        document.read_text().replace("initial_belief:", "initial_belief:\nstd::vector<int>{}.at(3);")
    )
    done = up("--model")
    assert done.returncode == 7, done.stdout + done.stderr
    assert "fetch.ef:" in done.stderr


def test_an_interface_that_the_robot_defines_otherwise_ends_the_start_at_once(project: Path):
    robot = project / "fetch_robot.py"
    lack = 'token = f"aos/{ROBOT}/lack/{ADAPTER}/AOS509%3A it is no Trigger/{short}"'
    declare = "declared.append(session.liveliness().declare_token(token))"
    old = f"        {declare}"
    text = robot.read_text()
    assert old in text
    robot.write_text(text.replace(old, f'        if path == "/take":\n            {lack}\n{old}'))
    started_s = time.monotonic()
    done = up()
    assert done.returncode == 3, done.stdout
    why = "take: no adapter answers calls of /take: robot says: AOS509: it is no Trigger"
    assert f"AOS807: not every skill can be run, and to wait mends nothing: {why}" in done.stderr
    assert time.monotonic() - started_s < 30, "the time that a program may take to serve its paths"


def test_two_processes_that_serve_one_path_are_told_at_the_start_each_with_its_process(project: Path):
    twice = "python fetch_robot.py & exec python fetch_robot.py"
    (project / "twice.sh").write_text(twice.replace("python", sys.executable))
    deploy = project / "fetch.yaml"
    text = deploy.read_text().replace(PROGRAMS, "")
    deploy.write_text(re.sub(r"\{command: [^}]*\}", "{command: [sh, twice.sh]}", text))
    robot = project / "fetch_robot.py"
    robot.write_text("".join(robot.read_text().splitlines(keepends=True)[2:]))
    command = [BIN / "aos-up", "fetch.yaml", "--plain"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            told = next(line for line in process.stdout if "is served by" in line)
            pids = {int(pid) for pid in re.findall(r"\(process (\d+) on [^)]+\)", told)}
            assert len(pids) == 2
            assert pids <= set(descendants(process.pid))
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=HANG_S)
