"""Many missions in one system that stays, played by their documents, with pushes and killed engines."""

import asyncio
import contextlib
import os
import random
import signal
import sys
import time
from asyncio.subprocess import DEVNULL, PIPE
from collections.abc import AsyncIterator
from pathlib import Path

import msgspec
from processes import descendants

from aos_deploy.bundles.files import files_of_bundle
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import RunRecord
from aos_protocol.access import OPERATOR
from aos_protocol.messages import BundleReport, DecisionRecord, MissionEntry, PushBundle
from aos_runtime.client import AosClient
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import mission_folder

from .harness import drained

_ROOT = Path(__file__).resolve().parents[2]
_BIN = Path(sys.executable).parent
_LINE_BYTES = 2**24
_PUSH_TIMEOUT_S = 300.0
_BUNDLE = _ROOT / "deploy/bundles/errand"
_DEPLOY = """aos: 1
robot: errand
bundles: [{bundle}]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission: {{goal_probability: 0.95, step_limit: 15}}
solver: {{simulations: 2000, planner: pomcp, seed: {seed}}}
bind: {{"*": model}}
runs: runs
"""

Decision = tuple[str, str, str]
"""An action, what was observed, and the belief after it."""


class Process(msgspec.Struct):
    """A service's memory and descriptors after a mission."""

    mission: int
    rss_kb: int
    descriptors: int


class Stayed(msgspec.Struct):
    """A system with many missions. `start_s` are the times from `start` to its answer, by mission.

    `decided_s` are those to the first decision. Missions whose documents were pushed since the one before are
    in `pushed`, those whose engine was killed in `killed`.
    """

    entries: list[MissionEntry] = []
    start_s: dict[int, float] = {}
    decided_s: dict[int, float] = {}
    pushed: list[int] = []
    killed: list[int] = []
    processes: dict[str, list[Process]] = {}
    run: Path = Path()
    faults: list[str] = []


async def stayed(folder: Path, missions: int, *, pushes: bool, kills: bool, chance: random.Random) -> Stayed:
    """Plays so many missions with the initial belief in one system, in an empty folder.

    Every third follows a push, and in every tenth the engine is killed.
    """
    result = Stayed()
    async with _up(folder, 1, "--stay") as record, _client(folder) as client:
        result.run = (folder / "runs" / "latest").resolve()
        first = await client.until_ended(f"{result.run.name}-1")
        result.entries.append(first)
        for number in range(2, missions + 1):
            if pushes and number % 3 == 0:
                await _push(client, number)
                result.pushed.append(number)
            began_s = time.monotonic()
            state = await client.start_mission(
                values={"target": chance.choice(["alice", "bob"])} if pushes else {}
            )
            result.start_s[number] = time.monotonic() - began_s
            if kills and number % 10 == 0 and _kill_engine(record, chance):
                result.killed.append(number)
            entry = await client.until_ended(state.mission)
            result.entries.append(entry)
            result.decided_s[number] = _first_decision_s(result.run, entry, began_s)
            if entry.ending not in ("goal", "step_limit"):
                result.faults.append(f"{entry.mission} ended as {entry.ending}: {entry.remark}")
            for name, pid in record.pids.items():
                result.processes.setdefault(name, []).append(_process(number, pid))
    return result


async def fresh(folder: Path, seed: int) -> list[Decision]:
    """The decisions of a system that ends with its mission."""
    _write(folder, seed)
    process = await asyncio.create_subprocess_exec(
        _BIN / "aos-up", "errand.yaml", "--plain", cwd=folder, stdout=DEVNULL
    )
    await process.wait()
    return decisions_of(folder / "runs" / "latest" / "journal.db")


def _write(folder: Path, seed: int) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "errand.yaml").write_text(_DEPLOY.format(bundle=_BUNDLE, seed=seed))


def decisions_of(journal: Path) -> list[Decision]:
    """The decisions in a journal."""
    with Journal.read(journal) as rows:
        records = [msgspec.json.decode(row.payload, type=DecisionRecord) for row in rows.walk("decision")]
    return [
        (record.action, record.outcome.response, msgspec.json.encode(record.belief).decode())
        for record in records
        if record.outcome is not None
    ]


def _first_decision_s(run: Path, entry: MissionEntry, began_s: float) -> float:
    """Returns the time from the row that it began to its first decision; 0 where there was none."""
    with Journal.read(mission_folder(run, entry.number) / "journal.db") as rows:
        first = next(rows.walk("decision"), None)
    return (first.stamp_ns - entry.begun_ns) / 1e9 if first is not None else 0.0


@contextlib.asynccontextmanager
async def _up(folder: Path, seed: int, *options: str) -> AsyncIterator[RunRecord]:
    _write(folder, seed)
    with (folder / "aos-up.log").open("w") as log:
        process = await asyncio.create_subprocess_exec(
            _BIN / "aos-up", "errand.yaml", "--json", *options,
            cwd=folder, stdout=PIPE, stderr=log, limit=_LINE_BYTES,
        )  # fmt: skip
        assert process.stdout is not None
        try:
            while b'"event":"decision"' not in (line := await process.stdout.readline()).replace(b" ", b""):
                assert line, (folder / "aos-up.log").read_text()
            draining = asyncio.create_task(drained(process.stdout))
            record = RunDirectory((folder / "runs" / "latest").resolve()).read_record()
            yield msgspec.structs.replace(record, pids={**record.pids, "aos-up": process.pid})
        finally:
            with contextlib.suppress(ProcessLookupError):
                process.send_signal(signal.SIGINT)
            await process.wait()
        await draining


def _client(folder: Path) -> contextlib.AbstractAsyncContextManager[AosClient]:
    return AosClient.of_run(folder / "runs" / "latest", OPERATOR)


async def _push(client: AosClient, number: int) -> None:
    """Pushes a bettered bundle: one of three rewards."""
    files = files_of_bundle(_BUNDLE, ())
    text = files["errand.ef"].decode().replace("__reward = 20;", f"__reward = {20 + number // 3 % 3};")
    bundle = PushBundle({**files, "errand.ef": text.encode()}, "bettered")
    report = await client.bus.ask(client.keys.push_bundle, bundle, BundleReport, timeout_s=_PUSH_TIMEOUT_S)
    assert report.is_accepted, report.diagnostics


def _kill_engine(record: RunRecord, chance: random.Random) -> bool:
    """Kills an engine of the solver, if there is one at this moment."""
    engines = [pid for pid in descendants(record.pids["solver"]) if _is_engine(pid)]
    if not engines:
        return False
    with contextlib.suppress(ProcessLookupError):
        os.kill(chance.choice(engines), signal.SIGKILL)
    return True


def _is_engine(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/exe").readlink().name == "model"
    return False


def _is_python(pid: int) -> bool:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/exe").readlink() == Path(sys.executable).resolve()
    return False


def _process(mission: int, pid: int) -> Process:
    """The service itself, where it runs behind a guard; engines and compilers are others'."""
    tree = [one for one in (pid, *descendants(pid)) if _is_python(one)]
    sizes = [found for one in tree if (found := _size(mission, one)) is not None]
    return max(sizes, key=lambda size: size.rss_kb)


def _size(mission: int, pid: int) -> Process | None:
    with contextlib.suppress(OSError):
        status = Path(f"/proc/{pid}/status").read_text()
        rss = [line.split()[1] for line in status.splitlines() if line.startswith("VmRSS")]
        if rss:
            return Process(mission, int(rss[0]), len(list(Path(f"/proc/{pid}/fd").iterdir())))
    return None
