"""A long history for somebody who joins late: order, time, and the memory that both sides take for it.

    python -m tests.long_history [--records N]

Writes a journal of so many records, as those of Tiger are, and lets a process answer from it on a real bus as
the solver does. Another process joins late and reads all. Growth is the peak of memory beyond that before the
first question.
"""

import argparse
import asyncio
import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import msgspec

from aos_protocol.keys import Keys
from aos_protocol.messages import (
    ActionValue,
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    History,
    HistoryQuery,
    Marginal,
    MissionQuery,
    MissionState,
    Outcome,
    PredictedObservation,
)
from aos_runtime.bus.bus import Bus
from aos_runtime.client import AosClient
from aos_runtime.disk.journal import Journal
from aos_runtime.processes.settings import ServiceSettings
from aos_solver.mission.records.history import history_page

ROBOT, MISSION = "tiger", "20260101T000000Z-tiger"
KEYS = Keys(ROBOT)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=100_000)
    parser.add_argument("--answer", nargs=2, metavar=("ENDPOINT", "JOURNAL"), help=argparse.SUPPRESS)
    parser.add_argument("--join", metavar="ENDPOINT", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.answer:
        asyncio.run(answer(*options.answer))
    elif options.join:
        asyncio.run(join(options.join, options.records))
    else:
        measure(options.records)


def measure(count: int) -> None:
    with tempfile.TemporaryDirectory() as folder, socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
        probe.close()
        journal = Path(folder, "journal.db")
        write(journal, count)
        say(f"{count} records, {journal.stat().st_size / 2**20:.0f} MiB of journal")
        settings = Path(folder, "router.json")
        router = ServiceSettings(robot=ROBOT, service="router", endpoint=endpoint, run_dir=folder)
        settings.write_bytes(msgspec.json.encode(router))
        own = [sys.executable, "-m", "tests.long_history", "--records", str(count)]
        with (
            subprocess.Popen([sys.executable, "-m", "aos_runtime.router", settings]) as routing,
            subprocess.Popen([*own, "--answer", endpoint, journal], stdin=subprocess.PIPE) as answering,
        ):
            try:
                subprocess.run([*own, "--join", endpoint], check=True)
            finally:
                answering.communicate()  # The end of its input ends it.
                routing.terminate()


async def answer(endpoint: str, journal: str) -> None:
    ended = MissionState(MISSION, "ended", 0, 0.0, ending="step_limit", epoch=1)

    async def history(query: HistoryQuery, _: str) -> History:
        return await asyncio.to_thread(history_page, Path(journal), MISSION, query)

    async def state(_: MissionQuery, __: str) -> MissionState:
        return ended

    async with await Bus.open(endpoint, sender="solver") as bus:
        await bus.answer(KEYS.decision_history, HistoryQuery, history)
        await bus.answer(KEYS.mission_state, MissionQuery, state)
        before = memory_bytes("VmRSS")
        await bus.announce(KEYS.live("solver"))
        await asyncio.to_thread(sys.stdin.read)
    say(f"who answers grows by {(memory_bytes('VmHWM') - before) / 2**20:.1f} MiB")


async def join(endpoint: str, count: int) -> None:
    """Reads all; fails unless each record comes once, in order."""
    async with AosClient.connect(endpoint, ROBOT) as client:
        before, begun_s, expected = memory_bytes("VmRSS"), time.monotonic(), 0
        async for record in client.decisions():
            assert record.sequence == expected, f"record {record.sequence} in place of {expected}"
            expected += 1
        assert expected == count, f"{expected} of {count} records came"
        took_s = time.monotonic() - begun_s
    grown = (memory_bytes("VmHWM") - before) / 2**20
    say(f"{count} records came in order in {took_s:.1f} s; who joins grows by {grown:.1f} MiB")


def write(path: Path, count: int) -> None:
    """A journal in which each record stands between two rows of other kinds."""
    with Journal.open(path, survives_power_loss=False) as journal:
        for sequence in range(count):
            record = record_of(sequence)
            journal.append("mission", MissionState(MISSION, "planning", record.step, 0.5, epoch=1))
            journal.append("decision", record)


def record_of(sequence: int) -> DecisionRecord:
    step = sequence // 2 + 1
    values = [ActionValue(name, -1.2345678, 33, 0.123456, -2.345678, 3.456789) for name in ("a", "b", "c")]
    predictions = tuple(PredictedObservation(name, 0.4999999) for name in ("hear_left", "hear_right"))
    outcome = Outcome(ActivationId(MISSION, step), "listen", "observed", "hear_left", {}, 1, 2)
    return DecisionRecord(
        sequence=sequence,
        stamp_ns=time.time_ns(),
        mission=MISSION,
        epoch=1,
        step=step,
        action="listen",
        skill="listen",
        parameters={},
        model_digest="0123456789abcdef0123456789abcdef",
        revision=1,
        seed=step,
        simulations=100,
        horizon=20,
        planning_s=0.0012345,
        actions=tuple(values),
        predicted=predictions,
        belief=BeliefSummary(
            (Marginal("tiger", {"left": 0.85, "right": 0.15}),), 0.42, 0.0, 0.0, 2, True, 1.34
        ),
        outcome=outcome if sequence % 2 else None,
        planner="pomcp",
        why="the deploy file asks for it",
    )


def memory_bytes(field: str) -> int:
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * int(next(line for line in lines if line.startswith(f"{field}:")).split()[1])


def say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    os.environ.setdefault("AOS_LOG", "WARNING")
    main()
