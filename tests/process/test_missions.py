import asyncio
import json
import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from gateway import write_slow_tiger
from places import BIN, BUNDLES, ROOT
from processes import HANG_S, EventReader, finished, kill, until_taking_over

from aos_deploy.history_check.files import check_run
from aos_protocol.access import OPERATOR
from aos_protocol.errors import SkillError
from aos_protocol.messages import BundleReport, PushBundle
from aos_runtime.client import AosClient
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import mission_folder
from aos_solver.mission.records.logbook import entries_of

DEPLOY = """\
aos: 1
robot: tiger
bundles: [tiger]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission: {{goal_probability: 1.0, step_limit: 3, activation_timeout_s: 900}}
solver: {{simulations: 200, planner: pomcp}}
bind: {{/listen: {{python: robot.py:listen}}, /open: {{python: robot.py:open_door}}}}
"""
ROBOT = """\
import asyncio
from pathlib import Path

SLOW = Path(__file__).with_name("slow")

async def listen(call):
    while SLOW.exists():
        await asyncio.sleep(0.05)
    return {"loudest": "left"}

async def open_door(call, door):
    return {}
"""


class System:
    def __init__(self, folder: Path, process: subprocess.Popen[str], environment: dict[str, str]):
        self.folder = folder
        self.process = process
        self._environment = environment
        self._events = EventReader(process)
        self.ended = self._events.ended
        self.kill = self._events.kill

    def until(self, kind: str, **fields: Any) -> dict[str, Any]:
        event = self._events.next(kind, **fields)
        assert event is not None, f"aos-up ended before {kind} {fields}"
        return event

    @property
    def run(self) -> Path:
        return (self.folder / "runs" / "latest").resolve()

    @property
    def record(self) -> dict[str, Any]:
        return json.loads((self.run / "run.json").read_text())

    def be_slow(self, is_slow: bool):
        slow = self.folder / "slow"
        slow.touch() if is_slow else slow.unlink(missing_ok=True)

    def aos(self, *arguments: str) -> tuple[int, str, str]:
        done = finished(BIN / "aos", *arguments, cwd=self.folder, env=self._environment)
        return done.returncode, done.stdout, done.stderr

    def interrupt(self) -> int:
        self.process.send_signal(signal.SIGINT)
        return self.ended()

    def beliefs(self, number: int) -> list[dict[str, Any]]:
        with Journal.read(mission_folder(self.run, number) / "journal.db") as journal:
            records = [json.loads(row.payload) for row in journal.walk("decision")]
        return [record["belief"]["marginals"] for record in records]


@contextmanager
def up(folder: Path, *options: str) -> Iterator[System]:
    environment = {**os.environ, "AOS_RUNNING_DIR": str(folder / "running")}
    write_slow_tiger(folder)
    (folder / "tiger.yaml").write_text(DEPLOY.format(root=ROOT))
    (folder / "errand.yaml").write_text(ERRAND.format(root=ROOT))
    (folder / "robot.py").write_text(ROBOT)
    command = [BIN / "aos-up", *(options or ("tiger.yaml", "--stay")), "--json"]
    pipes = {"stdout": subprocess.PIPE, "stderr": None}
    with subprocess.Popen(command, cwd=folder, text=True, env=environment, **pipes) as process:
        system = System(folder, process, environment)
        try:
            yield system
        finally:
            system.kill()


ERRAND = """\
aos: 1
robot: errand
bundles: [{root}/deploy/bundles/errand]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission: {{goal_probability: 0.95, set: {{target: alice}}}}
solver: {{simulations: 2000}}
stay: true
bind: {{"*": model}}
"""


@pytest.fixture
def stays(tmp_path) -> Iterator[System]:
    with up(tmp_path) as system:
        yield system


def test_ctrl_c_at_a_mission_that_is_waited_for_tells_how_to_end_it(stays: System):
    stays.until("mission", phase="ended")
    stays.be_slow(True)
    command = [BIN / "aos", "mission", "start", "--wait", "--run", stays.run]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as waits:
        assert waits.stdout is not None
        name = waits.stdout.readline().removesuffix(" has begun\n")
        stays.until("mission", phase="acting", mission=name)
        waits.send_signal(signal.SIGINT)
        _, said = waits.communicate(timeout=HANG_S)
    assert (waits.returncode, said) == (130, f"aos: {name} goes on; `aos mission stop` ends it\n")
    assert stays.aos("mission", "stop")[1] == f"{name}: cancelled after 1 step\n"


async def test_missions_follow_one_another_and_are_told_apart(stays: System):
    stays.be_slow(True)
    first = stays.until("mission", phase="acting")["mission"]
    name = stays.run.name
    assert json.loads(stays.aos("runs", "--json")[1])[0]["ending"] == "running"
    assert first == f"{name}-1"
    code, _, error = stays.aos("mission", "start")
    assert code == 3
    assert f"AOS515: the mission {first} runs" in error

    assert stays.aos("mission", "stop")[1] == f"{first}: cancelled after 1 step\n"
    assert stays.aos("mission", "stop")[1] == f"no mission runs: {first} has ended, cancelled\n"
    assert json.loads(stays.aos("runs", "--json")[1])[0]["ending"] == "waiting"
    stays.be_slow(False)
    assert stays.aos("mission", "start", "--wait")[0] == 6
    kept = stays.aos(
        "mission", "start", "--belief", "keep", "--given", "state.tiger_behind == Left", "--wait"
    )
    assert kept[0] == 6, kept[2]
    assert [marginal["values"] for marginal in stays.beliefs(3)[0]] == [{"Left": 1.0}]

    code, _, error = stays.aos("mission", "start", "--given", "state.tiger_behind == Lefd")
    assert code == 1
    assert "--given:1:23: error[AOS110]: unknown name `Lefd`. Did you mean `Left`?" in error
    given = "state.tiger_behind == Left && state.tiger_behind == Right"
    code, _, error = stays.aos("mission", "start", "--belief", "keep", "--given", given)
    assert code == 3
    assert f"AOS516: `{given}` has probability 0 in the last belief" in error

    async with AosClient.of_run(stays.run, OPERATOR) as aos:
        entry = await aos.until_ended((await aos.start_mission(idle=2)).mission)
        assert (entry.number, entry.ending, entry.steps, entry.seed) == (4, "step_limit", 3, 4)
        records = [record async for record in aos.history()]
        assert {record.mission for record in records} == {f"{name}-4"}
    assert stays.interrupt() == 0

    assert [(each.mission, each.ending) for each in entries_of(stays.run)] == [
        (f"{name}-1", "cancelled"),
        (f"{name}-2", "step_limit"),
        (f"{name}-3", "step_limit"),
        (f"{name}-4", "step_limit"),
    ]
    assert check_run(stays.run).violations == []
    (listed,) = json.loads(stays.aos("runs", "--json")[1])
    assert (listed["ending"], listed["steps"]) == ("stopped", 10)
    assert [each["ending"] for each in listed["missions"]] == ["cancelled", *["step_limit"] * 3]
    assert stays.aos("decisions", "--mission", "3")[1].count("step  1: ") == 2


async def test_a_solver_killed_between_missions_or_in_one_that_kept_its_belief_has_the_same_belief(
    stays: System,
):
    stays.until("mission", phase="ended")
    kill(stays.record["pids"]["solver"])
    stays.until("service", service="solver", state="ready")
    stays.be_slow(True)
    async with AosClient.of_run(stays.run, OPERATOR) as aos:
        mission = (await aos.start_mission(belief="keep")).mission
        stays.until("mission", mission=mission, phase="acting")
        kill(stays.record["pids"]["solver"])
        stays.until("service", service="solver", state="ready")
        with pytest.raises(SkillError, match=f"the mission {mission} runs") as refused:
            await aos.start_mission()
        assert refused.value.code == "AOS515"
        kill(stays.process.pid)
    stays.ended()
    assert stays.aos("mission", "list")[1].splitlines()[-1].startswith("killed ")
    assert "was killed. `aos-up --resume " in stays.aos("mission", "hold")[2]
    stays.be_slow(False)
    run = stays.run
    with up(stays.folder, "--resume") as again:
        assert again.until("mission", mission=mission, phase="ended")["ending"] == "step_limit"
        assert again.run == run
        again.be_slow(True)
        assert again.aos("mission", "start")[0] == 0
        again.until("mission", phase="acting")
        assert again.interrupt() == 130
    assert [entry.ending for entry in entries_of(run)] == ["step_limit", "step_limit", "cancelled"]
    assert again.beliefs(2)[0] == again.beliefs(1)[-1]
    assert check_run(run).violations == []


def test_a_skill_that_is_removed_while_it_runs_ends_first_and_the_last_one_stays(stays: System):
    stays.be_slow(True)
    stays.until("mission", phase="acting", step=1)
    removed = stays.aos("bundle", "rm", "tiger", "listen")
    assert removed[0] == 0, removed
    until_taking_over(stays.run, 2)
    stays.be_slow(False)
    stays.until("mission", phase="ended")
    code, said, _ = stays.aos("bundle", "rm", "tiger", "open")
    assert code == 1, said
    records = stays.aos("decisions", "--json")[1].splitlines()
    observed = [record for record in map(json.loads, records) if record.get("outcome")]
    assert observed[0]["outcome"]["response"] == "tiger_left"
    assert {record["skill"] for record in observed[1:]} == {"open"}
    assert stays.interrupt() == 0


async def test_the_next_mission_has_other_parameters_and_newer_documents(tmp_path):
    files = {path.name: path.read_bytes() for path in (BUNDLES / "errand").iterdir()}
    files["look.sd"] = files["look.sd"].replace(b"__reward = -1;", b"__reward = -2;")
    with up(tmp_path, "errand.yaml") as system:
        system.until("mission", phase="ended")
        code, _, error = system.aos("mission", "start", "--set", "target=bod")
        assert code == 1
        assert "error[AOS146]: target cannot be 'bod': it is one of alice, bob. Did you mean `bob`?" in error
        async with AosClient.of_run(system.run, OPERATOR) as aos:
            # A push beside the start, so that it comes before the first decision or after it.
            push = aos.bus.ask(aos.keys.push_bundle, PushBundle(files), BundleReport, timeout_s=HANG_S)
            state, report = await asyncio.gather(aos.start_mission(values={"target": "bob"}), push)
            assert report.is_accepted, report.diagnostics
            entry = await aos.until_ended(state.mission)
            assert (entry.ending, entry.values) == ("goal", {"target": "bob"})
            state = await aos.start_mission()
            assert state.revision == report.revision
            assert (await aos.until_ended(state.mission)).ending == "goal"
        run = system.run
        assert system.interrupt() == 0
    with Journal.read(mission_folder(run, 2) / "journal.db") as journal:
        actions = {json.loads(row.payload)["action"] for row in journal.walk("decision")}
    assert "give(to=bob)" in actions
    assert "give(to=alice)" not in actions
    assert check_run(run).violations == []
