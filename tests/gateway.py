import fcntl
import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse
from pathlib import Path
from typing import Any, NamedTuple

from places import BIN, BUNDLES, DEPLOY
from processes import COMMAND_S, HANG_S

SLOW = """\
aos: 1
robot: tiger
bundles: [tiger]
mission: {goal_probability: 1.0, step_limit: 1_000_000, activation_timeout_s: 900}
solver: {simulations: 100, planner: pomcp, ponder_while_acting: false}
bind: {/listen: {python: robot.py:listen}, /open: {python: robot.py:open_door}}
runs: runs
"""
SLOW_ROBOT = """\
import asyncio
import itertools
import os
from pathlib import Path

turns = os.open(Path(__file__).with_name("turns"), os.O_RDWR | os.O_NONBLOCK)
sides = itertools.cycle(("left", "right"))

async def listen(call):
    loop = asyncio.get_running_loop()
    has_turn = loop.create_future()
    loop.add_reader(turns, has_turn.set_result, None)
    try:
        await has_turn
    finally:
        loop.remove_reader(turns)
    os.read(turns, 1)
    return {"loudest": next(sides)}

async def open_door(call, door):
    await asyncio.Event().wait()
"""
"""A robot that hears both sides by turns, and waits for somebody to write into a pipe: a mission that goes
on as a test wants costs nothing.
"""
WORN = {
    "worn.yaml": """\
aos: 1
robot: lamp
bundles: [lamp]
stay: true
mission: {goal_probability: 1.0, step_limit: 8, set: {room: hall}}
solver: {simulations: 50}
bind: {/press: {python: robot.py:press}}
runs: runs
""",
    "robot.py": """\
async def press(call, room):
    return {"response": "stuck"}
""",
    "lamp/lamp.ef": """\
project: lamp
horizon: 3
discount: 0.9

define_type: Room
enum_members: hall, lab

mission_parameter: Room room
default_value: hall

state_variable: bool is_lit

reward_code:
if (state.is_lit) __reward = 10;
""",
    "lamp/press.sd": """\
project: lamp
parameter: Room room

available_parameters_code:
__possibleParameters.push_back(std::make_tuple(state.room));

dynamic_model:
__moduleResponse = AOS.Bernoulli(0.9) ? pressed : stuck;
state__.is_lit = __moduleResponse == pressed;
__reward = -1;
""",
}
"""A switch that its document holds to work in nine of ten uses, and that never does."""


class Answer(NamedTuple):
    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


class Gateway(NamedTuple):
    port: int
    token: str
    process: subprocess.Popen[str]
    folder: Path

    def ask(
        self,
        path: str,
        method: str = "GET",
        body: bytes | None = None,
        *,
        has_token: bool = True,
        headers: dict[str, str] | None = None,
    ) -> Answer:
        connection = HTTPConnection("127.0.0.1", self.port, timeout=HANG_S)
        sent = {"authorization": f"Bearer {self.token}"} if has_token else {}
        connection.request(method, path, body, sent | (headers or {}))
        answer = connection.getresponse()
        found = {name.lower(): text for name, text in answer.getheaders()}
        with_body = Answer(answer.status, found, answer.read())
        connection.close()
        return with_body

    def post(self, path: str, body: Any = None) -> Answer:
        return self.ask(path, "POST", json.dumps(body or {}).encode())

    @contextmanager
    def events(self, path: str, last: str = "") -> Iterator[Iterator[tuple[str, str, Any]]]:
        """The events of a stream: id, kind, data."""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=HANG_S)
        headers = {"authorization": f"Bearer {self.token}"} | ({"last-event-id": last} if last else {})
        connection.request("GET", path, headers=headers)
        try:
            yield _events(connection.getresponse())
        finally:
            connection.close()


def _events(answer: HTTPResponse) -> Iterator[tuple[str, str, Any]]:
    fields: dict[str, str] = {}
    for raw in answer:
        line = raw.decode().rstrip("\n")
        if line:
            name, _, text = line.partition(": ")
            fields[name] = text
        elif "data" in fields:
            yield fields.get("id", ""), fields["event"], json.loads(fields["data"])
            fields = {}


def environment(folder: Path) -> dict[str, str]:
    """The environment of commands that shall find no run but those of a folder."""
    own = {"AOS_RUNNING_DIR": "running", "AOS_GATEWAY_DIR": "gateway"}
    return {**os.environ, **{name: str(folder / place) for name, place in own.items()}}


@contextmanager
def gateway(folder: Path, *options: str) -> Iterator[Gateway]:
    port = () if "--port" in options else ("--port", "0")
    with running(folder, "aos", "serve", *port, *options) as process:
        assert process.stdout is not None
        address = process.stdout.readline()
        found = re.match(r"http://[^:]+:(\d+)/#/\S*\?token=(\S+)", address)
        assert found is not None, address
        yield Gateway(int(found[1]), found[2], process, folder)


@contextmanager
def running(folder: Path, command: str, *options: str | Path) -> Iterator[subprocess.Popen[str]]:
    """A command of ours in a folder, with its output in a pipe. It is told to stop at the block's end."""
    process = subprocess.Popen(
        [BIN / command, *options], cwd=folder, env=environment(folder), stdout=subprocess.PIPE, text=True
    )
    try:
        yield process
    finally:
        process.terminate()
        process.communicate(timeout=HANG_S)


def played(folder: Path, *options: str, said: Path | None = None) -> Path:
    """The directory of a mission that has run to its end, each skill played by its document.

    A file gets what was `said`; gateways that it starts write there as well.
    """
    runs = folder / "runs"
    command: list[str | Path] = [
        BIN / "aos-up",
        DEPLOY / "errand.yaml",
        "--model",
        "--plain",
        "--runs",
        runs,
        *options,
    ]
    with (said or folder / "said").open("wb") as out:
        subprocess.run(
            command, cwd=folder, env=environment(folder), stdout=out, timeout=COMMAND_S, check=False
        )
    return (runs / "latest").resolve()


def copied_past(shared: Path, folder: Path) -> Path:
    """The directory, below a folder, of a copy of the mission that the first who asks plays for all."""
    shared.mkdir(exist_ok=True)
    with (shared / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (shared / "played").exists():
            (shared / "played").write_text(played(shared).name)
    shutil.copytree(shared / "runs", folder / "runs", symlinks=True)
    return folder / "runs" / (shared / "played").read_text()


def write_slow_tiger(folder: Path) -> None:
    (folder / "tiger").mkdir(exist_ok=True)
    for path in (BUNDLES / "bench/tiger").iterdir():
        text = path.read_text().replace("max_duration: 10\n", "max_duration: 900\n")
        (folder / "tiger" / path.name).write_text(text)


def slow_deploy_file(folder: Path, step_limit: int = 1_000_000) -> Path:
    os.mkfifo(folder / "turns")
    write_slow_tiger(folder)
    (folder / "robot.py").write_text(SLOW_ROBOT)
    deploy_file = folder / "tiger.yaml"
    deploy_file.write_text(SLOW.replace("1_000_000", str(step_limit)))
    return deploy_file


@contextmanager
def slow_system(folder: Path, *options: str) -> Iterator[Path]:
    """The directory of a mission that goes on: its robot listens once for each write to the pipe `turns`."""
    with _up(folder, slow_deploy_file(folder).name, *options) as lines:
        next(line for line in lines if line["event"] == "decision")
        yield (folder / "runs/latest").resolve()


@contextmanager
def worn_system(folder: Path) -> Iterator[Path]:
    """The directory of a system that stays, whose first mission has ended with an alarm of its only skill."""
    for name, text in WORN.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    with _up(folder, "worn.yaml") as lines:
        next(line for line in lines if "`aos mission start`" in line.get("text", ""))
        yield (folder / "runs/latest").resolve()


@contextmanager
def _up(folder: Path, deploy_file: str, *options: str) -> Iterator[Iterator[dict[str, Any]]]:
    """The events of a system, which ends with the block."""
    with running(folder, "aos-up", deploy_file, "--json", *options) as process:
        assert process.stdout is not None
        yield map(json.loads, process.stdout)
