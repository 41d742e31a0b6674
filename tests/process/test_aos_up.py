import contextlib
import json
import os
import re
import shutil
import signal
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from deploy_files import world_without_pictures
from gateway import slow_deploy_file
from places import BIN, BUNDLES, DEPLOY, ROOT
from processes import HANG_S, descendants, finished, is_running, until_ended

from aos_deploy.history_check.files import check_run
from aos_deploy.runs.end import account_of
from aos_runtime.disk.journal import Journal

ENDINGS = {"goal": 0, "failure": 4, "nothing_worthwhile": 5, "step_limit": 6}


@pytest.fixture(scope="module")
def deploy_file(tmp_path_factory) -> Path:
    """The shipped deploy file on a free port, with a small planning budget and runs of its own."""
    folder = tmp_path_factory.mktemp("deploy")
    text = (DEPLOY / "armadillo.yaml").read_text()
    replaced = {
        "- bundles/": f"- {ROOT}/deploy/bundles/",
        "world: worlds/armadillo.yaml": f"world: {world_without_pictures(folder)}",
        "simulations: 100_000": "simulations: 5_000",
        "runs: ../runs": "runs: runs",
    }
    for old, new in replaced.items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "armadillo.yaml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module", autouse=True)
def scratch(tmp_path_factory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("scratch")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", str(folder))
        yield folder


SHARED_BEFORE: set[Path] = set()


@pytest.fixture(scope="module", autouse=True)
def _shared_before():
    """Notes what programs of others have left, such as a killed node that lets Zenoh share memory."""
    SHARED_BEFORE.update(Path("/dev/shm").iterdir())


def files_left(scratch: Path) -> list[Path]:
    """Temporary files and shared memory that nobody removed."""
    shared = set(Path("/dev/shm").iterdir()) - SHARED_BEFORE
    return [*scratch.iterdir(), *(path for path in shared if "aos" in path.name or "zenoh" in path.name)]


class Up:
    """A running aos-up that prints JSON events."""

    def __init__(self, process: subprocess.Popen[str]):
        self.process = process
        self.events: list[dict[str, Any]] = []
        self.pids: list[int] = []

    def until(self, kind: str) -> dict[str, Any]:
        """The next event of a kind; on the way, everything below the process is noted."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            event = json.loads(line)
            self.events.append(event)
            if event["event"] == kind:
                self.pids = [self.process.pid, *descendants(self.process.pid)]
                return event
        pytest.fail(f"aos-up ended before any {kind}: {self.events}\n{self.error_text()}")

    def until_ready(self, service: str):
        while True:
            event = self.until("service")
            if (event["service"], event["state"]) == (service, "ready"):
                return

    def error_text(self) -> str:
        assert self.process.stderr is not None
        return self.process.stderr.read()

    def rest(self) -> int:
        """Reads to the end; the exit code."""
        assert self.process.stdout is not None
        self.events += [json.loads(line) for line in self.process.stdout]
        return self.process.wait(HANG_S)


@contextmanager
def up(deploy_file: Path, *options: str) -> Iterator[Up]:
    process = subprocess.Popen(
        [BIN / "aos-up", deploy_file, "--json", *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    with process:
        try:
            yield Up(process)
        finally:
            process.kill()


def latest(deploy_file: Path) -> Path:
    return (deploy_file.parent / "runs" / "latest").resolve()


def has_a_bus(run: Path) -> bool:
    path = json.loads((run / "run.json").read_text())["endpoint"].removeprefix("unixsock-stream/")
    with socket.socket(socket.AF_UNIX) as probe:
        return probe.connect_ex(path) == 0


class Mission(NamedTuple):
    up: Up
    status: int
    run: Path
    followed: list[dict[str, Any]]


@pytest.fixture(scope="module")
def mission(deploy_file: Path) -> Mission:
    with up(deploy_file) as running:
        running.until("decision")
        run = latest(deploy_file)
        follow = [BIN / "aos", "decisions", "--json", "--runs", run.parent]
        with subprocess.Popen(follow, stdout=subprocess.PIPE, text=True) as follower:
            status = running.rest()
            lines, _ = follower.communicate(timeout=HANG_S)
    return Mission(running, status, run, [json.loads(line) for line in lines.splitlines()])


def test_a_mission_ends_in_a_defined_way(mission: Mission):
    ended = [event for event in mission.up.events if event["event"] == "mission"][-1]
    assert ended["phase"] == "ended"
    assert mission.status == ENDINGS[ended["ending"]]


def test_services_start_in_order_and_all_get_ready(mission: Mission):
    services = [event for event in mission.up.events if event["event"] == "service"]
    order = [event["service"] for event in services if event["state"] == "starting"]
    assert order == ["router", "registry", "middleware", "pybullet", "solver"]
    assert {event["service"] for event in services if event["state"] == "ready"} == set(order)
    assert [event["service"] for event in services if event["state"] == "ended"] == order[::-1]


def test_the_run_directory_keeps_the_mission(mission: Mission):
    summary = json.loads((mission.run / "summary.json").read_text())
    decided = [event for event in mission.up.events if event["event"] == "decision"]
    verdict = account_of(mission.run).verdict()
    assert summary["exit_code"] == verdict.exit_code == mission.status
    assert summary["ending"] == verdict.ending
    assert summary["actions"] == [event["action"] for event in decided if "outcome" in event]
    assert 0 < summary["services_ready_s"] < summary["first_decision_s"] < summary["duration_s"]
    for service in ("router", "registry", "middleware", "pybullet", "solver"):
        assert (mission.run / "logs" / f"{service}.log").stat().st_size > 0
    assert list((mission.run / "faults").iterdir()) == []


def test_the_history_of_a_mission_breaks_no_rule(mission: Mission):
    checked = finished(BIN / "aos", "check", mission.run, "--json")
    assert json.loads(checked.stdout)["violations"] == []
    assert checked.returncode == 0


def test_who_joins_late_has_every_decision(mission: Mission):
    with Journal.read(mission.run / "journal.db") as journal:
        journaled = [json.loads(row.payload) for row in journal.rows("decision")]
    assert mission.followed == journaled
    assert [record["sequence"] for record in journaled] == list(range(len(journaled)))


def test_a_finished_mission_can_be_read(mission: Mission):
    command = [BIN / "aos", "decisions", "--run", mission.run]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert len([line for line in text.splitlines() if line.startswith("step")]) == len(mission.followed)
    assert [line for line in text.splitlines() if re.match(r" {9}\w+: ", line)]
    assert text.splitlines()[-1].startswith("mission ended: ")


def test_nothing_is_left_after_a_normal_end(mission: Mission, scratch: Path):
    assert len(mission.up.pids) >= 6
    assert not any(is_running(pid) for pid in mission.up.pids)
    assert not has_a_bus(mission.run)
    assert not files_left(scratch)


async def test_nothing_is_left_when_aos_up_is_killed(deploy_file: Path, scratch: Path):
    with up(deploy_file) as running:
        running.until("decision")
        os.kill(running.process.pid, signal.SIGKILL)
        running.process.wait()
    await until_ended(running.pids)
    assert check_run(latest(deploy_file)).violations == []
    assert not has_a_bus(latest(deploy_file))
    assert not files_left(scratch)


def pids_of(deploy_file: Path) -> dict[str, int]:
    pids: dict[str, int] = json.loads((latest(deploy_file) / "run.json").read_text())["pids"]
    return pids


def summary_of(deploy_file: Path) -> dict[str, Any]:
    summary: dict[str, Any] = json.loads((latest(deploy_file) / "summary.json").read_text())
    return summary


def test_a_mission_goes_on_after_the_deaths_of_its_engine_and_of_services_and_ends_by_sigterm(
    tmp_path, scratch: Path
):
    file = slow_deploy_file(tmp_path)
    victims = ("router", "registry", "middleware", "solver")
    with up(file) as running:
        for step, victim in enumerate(("engine", *victims), 1):
            while running.until("decision")["step"] < step:
                pass
            if victim == "engine":
                for pid in descendants(pids_of(file)["solver"]):
                    with contextlib.suppress(ProcessLookupError):  # It has ended with the one before.
                        os.kill(pid, signal.SIGKILL)
            else:
                os.kill(pids_of(file)[victim], signal.SIGKILL)
                running.until_ready(victim)
            (tmp_path / "turns").write_bytes(b".")
        while running.until("decision")["step"] <= len(victims) + 1:
            pass
        os.kill(running.process.pid, signal.SIGTERM)
        assert running.rest() == 130
    assert not any(is_running(pid) for pid in running.pids)
    assert not files_left(scratch)
    assert not has_a_bus(latest(file))
    assert account_of(latest(file)).verdict().ending == summary_of(file)["ending"] == "cancelled"
    assert [end["name"] for end in summary_of(file)["process_ends"] if end["name"] in victims] == [*victims]


def test_a_mission_whose_output_nobody_reads_any_more_is_stopped_in_order(tmp_path):
    file = slow_deploy_file(tmp_path, step_limit=3)
    with up(file) as running:
        running.until("decision")
        assert running.process.stdout is not None
        running.process.stdout.close()
        (tmp_path / "turns").write_bytes(b"." * 9)
        assert running.process.wait(HANG_S) == 130
        assert running.error_text() == ""
    assert summary_of(file)["ending"] == "cancelled"


class Refused(NamedTuple):
    status: int
    text: str


def refused(deploy_file: Path, text: str, *options: str) -> Refused:
    """Runs a deploy file of this text and returns how it ends, without a traceback and without leaving a
    process."""
    changed = deploy_file.with_name("changed.yaml")
    changed.write_text(text)
    with up(changed, *options) as running:
        status = running.rest()
        error = running.error_text()
    assert "Traceback" not in error
    return Refused(status, error)


def test_a_path_that_nobody_serves_ends_the_start_and_is_named(deploy_file: Path):
    text = deploy_file.read_text()
    assert "  /serve: pybullet\n" in text
    result = refused(deploy_file, text.replace("  /serve: pybullet\n", ""))
    assert result.status == 3
    assert "AOS807: not every skill can be run within 1 s: serve: no adapter answers" in result.text
    assert "The deploy file binds /navigate to pybullet, " in result.text
    assert "aos-up --model" in result.text


def test_a_mistake_that_the_compiler_finds_is_shown_at_its_place(deploy_file: Path, tmp_path):
    bundle = shutil.copytree(BUNDLES / "armadillo-finer", tmp_path / "bundle")
    text = (bundle / "pick.sd").read_text()
    assert "__reward = -2;" in text
    (bundle / "pick.sd").write_text(text.replace("__reward = -2;", "__reward = minus_two;", 1))
    changed = deploy_file.read_text().replace(str(BUNDLES / "armadillo-finer"), str(bundle))
    result = refused(deploy_file, changed)
    assert result.status == 1
    assert "pick.sd:" in result.text
