"""The times until the skills of an adapter that leaves are unavailable, and until they run again when it
is back."""

import argparse
import asyncio
import os
import signal
import statistics
import time

from aos_protocol.messages import MappingState
from aos_runtime.bus.bus import Subscription

from .harness import PATIENCE_S, Harness, harness, project_of

MAX_S = 1.0

SKILL = """
async def skill(call):
    return {}
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=20, metavar="N", help="of each way to leave")


def measure(options: argparse.Namespace) -> int:
    """Prints the figures; 1 if an adapter was away for longer than it may before anybody was told."""
    return asyncio.run(_measure(options.runs))


async def _measure(runs: int) -> int:
    print(f"{runs} runs, seconds            gone: p50    max   back: p50    max   still runs")
    missed = False
    for name, death in (("killed", signal.SIGKILL), ("frozen", signal.SIGSTOP)):
        async with harness(project_of({"skill": ""})) as made:
            gone, back, good = await _leave(made, death, runs)
        missed = missed or max(gone) > MAX_S or good < runs
        print(
            f"{name:28}",
            *(f"{statistics.median(times_s):.3f}  {max(times_s):.3f}" for times_s in (gone, back)),
            good,
        )
    return int(missed)


async def _leave(made: Harness, death: signal.Signals, runs: int) -> tuple[list[float], list[float], int]:
    """Returns for each run the times until the skill is told to be unavailable and available again, and
    the good outcomes."""
    gone, back, good = [], [], 0
    child = await made.adapter(SKILL, {"/skill": "skill"})
    await made.until_available(skills=1)
    async with made.bus.listen(made.keys.mapping_state, MappingState) as states:
        for step in range(1, runs + 1):
            started_s = time.monotonic()
            os.kill(child.pid, death)
            await _until(states, is_available=False)
            gone.append(time.monotonic() - started_s)
            started_s = time.monotonic()
            if death == signal.SIGSTOP:
                os.kill(child.pid, signal.SIGCONT)
            else:
                await child.wait()
                child = await made.adapter(SKILL, {"/skill": "skill"})
            await _until(states, is_available=True)
            back.append(time.monotonic() - started_s)
            good += (await made.activate("skill", step)).status == "observed"
    return gone, back, good


async def _until(states: Subscription[tuple[str, MappingState]], *, is_available: bool) -> None:
    async with asyncio.timeout(PATIENCE_S):
        async for _, state in states:
            if ("skill" not in state.unavailable) is is_available:
                return
