"""Pushes at random moments of real missions: what becomes of the mission, and how soon each is used."""

import asyncio
import contextlib
import itertools
import random
import sys
import time
from asyncio.subprocess import PIPE
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import msgspec

from aos_protocol.access import OPERATOR
from aos_protocol.messages import (
    BundleReport,
    DecisionRecord,
    MappingState,
    MissionState,
    PushBundle,
    RemoveDocuments,
)
from aos_runtime.client import AosClient

from .changes import Change, Project

_ROOT = Path(__file__).resolve().parents[2]
_BIN = Path(sys.executable).parent
_LINE_BYTES = 2**24

_DEPLOY = """aos: 1
robot: tester
project: plug
bundles: [bundle]
bus: {{listen: "tcp/127.0.0.1:0"}}
mission: {{step_limit: 1000000, goal_probability: 1.0}}
solver: {{simulations: 200, planner: pomcp, threads: 1, seed: {seed}}}
bind:
  /listen: {{python: "{robot}:listen"}}
  /wait: {{python: "{robot}:wait"}}
runs: runs
"""

_PUSH_TIMEOUT_S = 200.0
_USED_TIMEOUT_S = 60.0
_STEPS_S = 0.3


class Pushed(msgspec.Struct):
    """A push: whether it was accepted, how long that took, and when a decision used it, from the sending."""

    kind: str
    revision: int = 0
    is_accepted: bool = False
    answered_s: float = 0.0
    used_s: float | None = None
    superseded: bool = False
    by: str = ""


class Played(msgspec.Struct):
    """A mission with pushes. `between_s` are the times from an outcome to the next decision, without the
    search.
    """

    seed: int
    ending: str = ""
    steps: int = 0
    pushed: list[Pushed] = []
    between_s: list[float] = []
    faults: list[str] = []


async def played(
    folder: Path, seed: int, kinds: Sequence[str], undisturbed: int = 0, superseded: float = 0.2
) -> Played:
    """Plays a mission in an empty folder, with so many undisturbed steps and then a push of each kind.

    A push is followed by the next one at once with the probability `superseded`.
    """
    project = Project(seed)
    bundle = folder / "bundle"
    bundle.mkdir(parents=True)
    for name, text in project.files.items():
        (bundle / name).write_bytes(text)
    text = _DEPLOY.format(seed=seed, robot=_ROOT / "tests/plug/robot.py")
    (folder / "tester.yaml").write_text(text)
    result = Played(seed)
    async with _up(folder), AosClient.of_run(folder / "runs" / "latest", OPERATOR) as client:
        game = _Game(client, project, result, random.Random(seed))
        await game.play(kinds, undisturbed, superseded)
    return result


@contextlib.asynccontextmanager
async def _up(folder: Path) -> AsyncIterator[None]:
    """A mission that has decided, until the end of the block."""
    with (folder / "aos-up.log").open("w") as log:
        process = await asyncio.create_subprocess_exec(
            _BIN / "aos-up", "tester.yaml", "--json", cwd=folder, stdout=PIPE, stderr=log, limit=_LINE_BYTES
        )
        assert process.stdout is not None
        try:
            while b'"event":"decision"' not in (line := await process.stdout.readline()).replace(b" ", b""):
                assert line, (folder / "aos-up.log").read_text()
            draining = asyncio.create_task(_drained(process.stdout))
            yield
        finally:
            with contextlib.suppress(ProcessLookupError):
                process.terminate()
            await process.wait()
        await draining


class _Game:
    def __init__(self, client: AosClient, project: Project, result: Played, chance: random.Random):
        self._client, self._project, self._result = client, project, result
        self._chance = chance
        self._decided = asyncio.Event()
        self._records: list[tuple[float, DecisionRecord]] = []
        self._mapped: list[tuple[int, ...]] = []
        self._is_over = False

    async def play(self, kinds: Sequence[str], undisturbed: int, superseded: float):
        async with asyncio.TaskGroup() as tasks:
            followers = [tasks.create_task(self._follow()), tasks.create_task(self._follow_mappings())]
            await self._steps(undisturbed)
            for kind in kinds:
                if not self._is_over:
                    await self._push(self._project.change(kind), superseded)
            for follower in followers:
                follower.cancel()
        if self._is_over:
            self._result.faults.append(f"the mission ended as {self._result.ending} among the pushes")
        self._judge()

    async def _follow(self):
        async for event in self._client.follow():
            if isinstance(event, DecisionRecord):
                self._records.append((time.monotonic(), event))
            elif isinstance(event, MissionState) and event.phase == "ended":
                self._result.ending = f"{event.ending}: {event.remark}"
                self._is_over = True
            self._decided.set()

    async def _follow_mappings(self):
        async with self._client.bus.listen(self._client.keys.mapping_state, MappingState) as told:
            async for _, state in told:
                self._mapped.append(state.revisions)

    async def _push(self, change: Change, superseded: float):
        await self._steps(self._chance.randint(0, 3))
        await self._until(self._chance.uniform(0.0, _STEPS_S))
        pushed = Pushed(change.kind)
        self._result.pushed.append(pushed)
        sent_s = time.monotonic()
        report = await self._sent(change)
        pushed.answered_s = time.monotonic() - sent_s
        pushed.revision, pushed.is_accepted = report.revision, report.is_accepted
        if report.is_accepted == (change.kind == "broken"):
            said = "; ".join(each.message for each in report.diagnostics)
            self._result.faults.append(
                f"{change.kind}: {'accepted' if report.is_accepted else 'refused'}: {said}"
            )
        if not report.is_accepted:
            return
        if self._chance.random() < superseded:
            pushed.superseded = True  # The next one comes at once.
            return
        until_s = time.monotonic() + _USED_TIMEOUT_S
        while not self._is_over and time.monotonic() < until_s:
            found = [(at_s, each) for at_s, each in self._records if each.revision >= report.revision]
            if found:
                pushed.used_s = max(found[0][0] - sent_s, 0.0)
                adopted = found[0][1].adopted
                pushed.by = adopted.by if adopted is not None else ""
                return
            await self._next_event(until_s - time.monotonic())
        self._result.faults.append(f"revision {report.revision}, {change.kind}, was not used")

    async def _sent(self, change: Change) -> BundleReport:
        keys, bus = self._client.keys, self._client.bus
        if change.removed:
            removal = RemoveDocuments("plug", change.removed)
            return await bus.ask(keys.remove_bundle, removal, BundleReport, timeout_s=_PUSH_TIMEOUT_S)
        bundle = PushBundle(change.files, change.kind)
        return await bus.ask(keys.push_bundle, bundle, BundleReport, timeout_s=_PUSH_TIMEOUT_S)

    async def _steps(self, count: int):
        enough = len(self._records) + 2 * count
        while len(self._records) < enough and not self._is_over:
            await self._next_event(_USED_TIMEOUT_S)

    async def _until(self, seconds: float):
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await asyncio.Event().wait()

    async def _next_event(self, timeout_s: float):
        self._decided.clear()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(max(timeout_s, 0.0)):
                await self._decided.wait()

    def _judge(self):
        result = self._result
        records = [record for _, record in self._records]
        had = {revision for kept in self._mapped for revision in kept}
        first = records[0].revision if records else 0
        for record in records:
            if record.revision != first and record.revision not in had:
                result.faults.append(
                    f"step {record.step} was decided by {record.revision}, which is not mapped"
                )
        result.steps = max((record.step for record in records), default=0)
        result.between_s = between(records)


def between(records: Sequence[DecisionRecord]) -> list[float]:
    found = []
    for before, after in itertools.pairwise(records):
        if before.outcome is not None and after.outcome is None:
            found.append((after.stamp_ns - before.stamp_ns) / 1e9 - after.planning_s)
    return found


async def _drained(stream: asyncio.StreamReader):
    while await stream.read(2**16):
        pass
