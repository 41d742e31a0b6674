"""The latency from the solver's activation to the skill, and from its result to the observation."""

import argparse
import asyncio
import time
from collections.abc import Sequence

from aos_protocol.messages import MappingQuery, MappingState
from aos_runtime.bus import Bus

from .harness import harness, project_of

MAX_P99_MS = 5.0
MAX_ROUND_TRIPS = 3.0

SKILL = """
import time
async def skill(call):
    started = time.time_ns()
    return {"started": started, "ended": time.time_ns()}
"""
MAPPING = """\
local_variable: started
type: int
from_ros_service_response: true
code:
started = __input.started
local_variable: ended
type: int
from_ros_service_response: true
code:
ended = __input.ended
"""


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--calls", type=int, default=300, metavar="N")


def measure(options: argparse.Namespace) -> int:
    """Prints the figures; 1 if a target was missed."""
    return asyncio.run(_measure(options.calls))


async def _measure(calls: int) -> int:
    async with harness(project_of({"skill": MAPPING})) as made:
        await made.adapter(SKILL, {"/skill": "skill"})
        await made.until_available(skills=1)
        for step in range(1, 11):  # Workers start, caches fill.
            await made.activate("skill", step)
        round_trips = await _round_trips(made.bus, made.endpoint, calls)
        there, back = [], []
        for step in range(11, 11 + calls):
            sent_ns = time.time_ns()
            outcome = await made.activate("skill", step)
            received_ns = time.time_ns()
            there.append((int(outcome.local_variables["started"]) - sent_ns) / 1e6)
            back.append((received_ns - int(outcome.local_variables["ended"])) / 1e6)
    bare = _quantile(round_trips, 0.5)
    print(f"{calls} calls, milliseconds       p50    p99   p50 in bare round trips")
    missed = False
    for name, values in (("activation to skill", there), ("result to observation", back)):
        p50, p99 = _quantile(values, 0.5), _quantile(values, 0.99)
        missed = missed or p99 > MAX_P99_MS or p50 > MAX_ROUND_TRIPS * bare
        print(f"{name:28} {p50:6.2f} {p99:6.2f}   {p50 / bare:.1f}")
    print(f"{'bare Zenoh round trip':28} {bare:6.2f} {_quantile(round_trips, 0.99):6.2f}")
    return int(missed)


async def _round_trips(bus: Bus, endpoint: str, calls: int) -> list[float]:
    """Returns the times of a query through the router to another session, and its answer, in milliseconds."""

    async def answer(_: MappingQuery, __: str) -> MappingState:
        return MappingState(0, ())

    times = []
    async with await Bus.open(endpoint, sender="echo") as other:
        await other.answer("aos/numbers/echo", MappingQuery, answer)
        for _ in range(calls):
            start = time.perf_counter()
            await bus.ask("aos/numbers/echo", MappingQuery(), MappingState, timeout_s=5.0)
            times.append((time.perf_counter() - start) * 1e3)
            await asyncio.sleep(0)
    return times


def _quantile(values: Sequence[float], share: float) -> float:
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]
