import json
import os
import signal
import socket
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from places import BIN, ROOT
from processes import HANG_S, EventReader, finished

from aos_deploy.processes.endpoint import hold_endpoint
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import RunRecord
from aos_protocol.errors import BusError
from aos_protocol.messages import MissionBegun
from aos_protocol.mission_rows import BEGUN
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import JOURNAL

TIGER = """\
aos: 1
robot: tiger
bundles: [{root}/deploy/bundles/bench/tiger]
bus: {{listen: "{endpoint}"}}
mission: {{goal_probability: 1.0, step_limit: 100_000, set_aside_after: 100_000, failure_limit: 100_000}}
solver: {{simulations: 100, planner: pomcp, ponder_while_acting: false}}
bind: {{/listen: {{python: robot.py:listen}}, /open: {{python: robot.py:open_door}}}}
runs: runs
"""
SLOW_ROBOT = """\
import asyncio

async def listen(call):
    await asyncio.Event().wait()

async def open_door(call, door):
    await asyncio.Event().wait()
"""
"""A mission that goes on costs nothing: its robot moves until its time is over, again and again."""


class Up:
    """A running aos-up."""

    def __init__(self, process: subprocess.Popen[str]):
        self._process = process
        self._events = EventReader(process)
        self.kill = self._events.kill

    def has_decided(self) -> bool:
        """Returns whether it came to a decision before its end."""
        return self._events.next("decision") is not None

    def end(self) -> tuple[int, str]:
        """Exit code and errors after Ctrl-C."""
        self._process.send_signal(signal.SIGINT)
        return self.ended()

    def ended(self) -> tuple[int, str]:
        assert self._process.stderr is not None
        error = self._process.stderr.read()
        return self._events.ended(), error


class Place:
    """A folder with a deploy file of a mission that does not end, and the commands in it.

    Missions are noted in `running`, so that those of other tests are not seen.
    """

    def __init__(self, folder: Path, endpoint: str, running: Path):
        self.folder = folder
        self.endpoint = endpoint
        own = {"AOS_RUNNING_DIR": str(running), "PYTHONUNBUFFERED": "1"}
        self.environment = {**os.environ, **own}
        self.deploy = folder / "tiger.yaml"
        self.deploy.write_text(TIGER.format(root=ROOT, endpoint=endpoint))
        (folder / "robot.py").write_text(SLOW_ROBOT)

    @property
    def latest(self) -> Path:
        return (self.folder / "runs" / "latest").resolve()

    @contextmanager
    def up(self) -> Iterator[Up]:
        command = [BIN / "aos-up", self.deploy, "--json"]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        with subprocess.Popen(command, text=True, env=self.environment, **pipes) as process:
            up = Up(process)
            try:
                yield up
            finally:
                up.kill()

    def run(self, *arguments: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
        return finished(BIN / "aos", *arguments, cwd=folder or self.folder, env=self.environment)


def free_port() -> int:
    with hold_endpoint("tcp/127.0.0.1:0") as endpoint:
        return int(endpoint.rpartition(":")[2])


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Place:
    endpoint, running = f"tcp/127.0.0.1:{free_port()}", tmp_path_factory.mktemp("running")
    return Place(tmp_path_factory.mktemp("place"), endpoint, running)


@pytest.fixture(scope="module")
def mission(place: Place) -> Iterator[Path]:
    with place.up() as up:
        assert up.has_decided()
        yield place.latest
        assert up.end() == (130, "")


def test_a_second_start_is_refused_and_latest_stays(place: Place, mission: Path):
    with place.up() as second:
        code, error = second.ended()
    assert code == 3
    assert f"cannot listen at {place.endpoint}: another AOS runs there. `aos runs` lists" in error
    assert place.latest == mission
    assert [run.name for run in mission.parent.glob("2*")] == [mission.name]


@pytest.mark.parametrize("is_elsewhere", [False, True], ids=["here", "elsewhere"])
def test_a_living_mission_is_found(place: Place, mission: Path, tmp_path, is_elsewhere):
    folder = tmp_path if is_elsewhere else place.folder
    decided = place.run("decisions", "--no-follow", "--json", folder=folder)
    assert json.loads(decided.stdout.splitlines()[0])["step"] == 1, decided.stderr
    assert place.run("bundle", "list", folder=folder).stdout.startswith("tiger  revision 1")
    (listed,) = json.loads(place.run("runs", "--running", "--json", folder=folder).stdout)
    assert (Path(listed["directory"]).name, listed["ending"]) == (mission.name, "running")


def test_a_living_mission_is_never_pruned(place: Place, mission: Path):
    printed = place.run(
        "runs", "--runs", str(mission.parent), "prune", "--keep", "0", "--json", folder=Path("/")
    )
    assert json.loads(printed.stdout)["kept"] == 1, printed.stderr
    assert mission.is_dir()


def test_of_two_living_missions_one_has_to_be_named(place: Place, mission: Path, tmp_path):
    (tmp_path / "other").mkdir()
    running = Path(place.environment["AOS_RUNNING_DIR"])
    other = Place(tmp_path / "other", "tcp/127.0.0.1:0", running)
    with other.up() as up:
        assert up.has_decided()
        anywhere = place.run("bundle", "list", folder=tmp_path)
        assert anywhere.returncode == 1
        assert str(mission) in anywhere.stderr
        assert "AOS901" in anywhere.stderr
        assert "Name one with --run" in anywhere.stderr
        assert place.run("bundle", "list", "--run", str(mission), folder=tmp_path).returncode == 0
        assert other.run("bundle", "list").returncode == 0  # Its own folder has one.
        assert up.end() == (130, "")


def test_a_system_is_ended_by_its_deploy_file_and_whoever_follows_its_logs_reads_them_to_the_end(tmp_path):
    place = Place(tmp_path, "tcp/127.0.0.1:0", tmp_path / "running")
    with place.up() as up:
        assert up.has_decided()
        command = [BIN / "aos", "logs", "router", "python", "--follow", "--json"]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        with subprocess.Popen(command, cwd=tmp_path, env=place.environment, text=True, **pipes) as following:
            assert following.stdout is not None
            first = json.loads(following.stdout.readline())
            assert (first["service"], "loading robot.py" in first["line"]) == ("python", True)
            assert "no system that runs is named lion" in place.run("down", "lion").stderr
            ended = json.loads(place.run("down", place.deploy.name, "--json").stdout)
            assert (ended["robot"], ended["ending"], ended["steps"]) == ("tiger", "cancelled", 1)
            assert up.ended() == (130, "")
            services = {json.loads(line)["service"] for line in following.stdout}
        assert (services, following.wait(HANG_S)) == ({"python", "router"}, 0)
    last = place.run("logs", "router", "--lines", "1")
    assert (last.stdout.startswith("router | "), last.stdout.count("\n")) == (True, 1)
    assert last.stderr == f"Logs of {ended['directory']}\n"
    assert "Did you mean `router`?" in place.run("logs", "ruter").stderr


def test_of_two_starts_at_once_one_runs(tmp_path):
    place = Place(tmp_path, f"tcp/127.0.0.1:{free_port()}", tmp_path)
    with place.up() as one, place.up() as other:
        decided = {start: start.has_decided() for start in (one, other)}
        codes = {decided[start]: start.end()[0] if decided[start] else start.ended()[0] for start in decided}
    assert codes == {True: 130, False: 3}


def test_a_run_that_was_killed_does_not_run_and_before_its_mission_began_has_not_started(
    place: Place, tmp_path
):
    killed = RunDirectory(tmp_path / "20260101T000000Z-tiger")
    killed.path.mkdir()
    # The process id is one that is there: in a new container it soon belongs to somebody else.
    record: dict[str, Any] = {"robot": "tiger", "endpoint": "tcp/127.0.0.1:1", "deploy_file": "x", "seed": 1}
    killed.write_record(RunRecord(**record, started="2026-01-01T00:00:00+00:00", pid=os.getpid()))
    assert not killed.is_running
    (killed.path / JOURNAL).touch()  # Its solver had no space for more.
    (listed,) = json.loads(place.run("runs", "--runs", str(tmp_path), "--json").stdout)[:1]
    assert listed["ending"] == "not_started"
    down = place.run("down", "--run", str(killed.path))
    assert "was killed before its mission began. `aos-up --resume" in down.stderr
    (killed.path / JOURNAL).unlink()
    with Journal.open(killed.path / JOURNAL) as journal:
        journal.append(BEGUN, MissionBegun(killed.path.name, 1, 1, 1, "digest"))
    (listed,) = json.loads(place.run("runs", "--runs", str(tmp_path), "--json").stdout)[:1]
    assert listed["ending"] == "killed"


def test_an_endpoint_is_held_by_one_start_at_a_time():
    with ExitStack() as first:
        endpoint = first.enter_context(hold_endpoint("tcp/127.0.0.1:0"))
        first.enter_context(hold_endpoint(endpoint.replace("127.0.0.1", "127.0.0.2")))
        with pytest.raises(BusError, match="another AOS runs there"):
            first.enter_context(hold_endpoint(endpoint.replace("127.0.0.1", "localhost")))
    with hold_endpoint(endpoint) as again:
        assert again == endpoint


def test_an_endpoint_where_another_program_listens_is_refused():
    with socket.create_server(("127.0.0.1", 0)) as server:
        endpoint = f"tcp/127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(BusError, match="Address already in use"), hold_endpoint(endpoint):
            pytest.fail("it was held")
