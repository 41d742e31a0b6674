"""Adapters that do everything wrong, a hundred times each: defined outcomes, in time, and memory flat."""

import argparse
import asyncio
import time
from pathlib import Path
from typing import NamedTuple

from aos_protocol.keys import Serving
from aos_protocol.messages import Cancel, Cancelled, Outcome, SkillCall, SkillResult, TopicMessage
from aos_runtime.bus.bus import Bus

from .harness import Harness, harness, project_of

TIMEOUT_S = 0.3
MARGIN_S = 0.5
MAX_GROWTH_KB = 8_192

FAULTY = """
import asyncio, os
async def raises(call):
    raise RuntimeError("gripper jammed")
async def at_once(call):
    os._exit(1)
async def in_the_middle(call):
    await asyncio.sleep(0.05)
    os._exit(1)
async def good(call):
    return {}
"""
LISTENING = """\
max_duration: 0.3
local_variable: level
topic: /level
message_type: Level
initial_value: 0
code:
return __input.data
"""


class Fault(NamedTuple):
    """The statuses that an outcome may have; the process that dies is started again each time."""

    statuses: tuple[str, ...]
    mapping: str = f"max_duration: {TIMEOUT_S}\n"
    dies: bool = False


FAULTS = {
    "never replies": Fault(("timed_out",)),
    "replies late": Fault(("timed_out",)),
    "replies twice": Fault(("observed",)),
    "replies for another id": Fault(("unknown",)),
    "raises": Fault(("failed",)),
    "dies at once": Fault(("unknown", "timed_out"), dies=True),
    "dies in the middle": Fault(("unknown", "timed_out"), dies=True),
    "unknown response": Fault(("observed", "failed"), "max_duration: 0.3\n"),
    "floods its topic": Fault(("observed",), LISTENING),
}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=100, metavar="N", help="of each fault")
    parser.add_argument("--fault", action="append", help="only this one; may be repeated")


def measure(options: argparse.Namespace) -> int:
    """Prints a line for each fault; 1 if one was not dealt with."""
    return asyncio.run(_measure(options.runs, options.fault))


async def _measure(runs: int, only: list[str] | None) -> int:
    missed = 0
    print("fault | runs | outcomes | longest s | memory KB")
    for name, fault in FAULTS.items():
        if only and name not in only:
            continue
        async with harness(project_of({"skill": fault.mapping})) as made:
            longest_s, statuses, growth_kb = await _run(made, name, fault, runs)
        is_good = statuses.keys() <= set(fault.statuses) and longest_s <= TIMEOUT_S + MARGIN_S
        missed += not (is_good and growth_kb <= MAX_GROWTH_KB)
        print(f"{name} | {runs} | {statuses} | {longest_s:.2f} | {growth_kb:+d}", flush=True)
    return int(missed > 0)


async def _run(made: Harness, name: str, fault: Fault, runs: int) -> tuple[float, dict[str, int], int]:
    function = {"dies at once": "at_once", "dies in the middle": "in_the_middle"}.get(name, name)
    if name == "raises" or fault.dies:
        child = await made.adapter(FAULTY, {"/skill": function})
    else:
        await _serve_wrongly(made.bus, made, name)
    await made.until_available(skills=1)
    await made.activate("skill", 1)
    longest_s, statuses, before_kb = 0.0, dict[str, int](), 0
    for step in range(2, runs + 2):
        if fault.dies:
            await child.wait()
            child = await made.adapter(FAULTY, {"/skill": function})
            await made.until_available(skills=1)
        started_s = time.monotonic()
        outcome: Outcome = await made.activate("skill", step)
        longest_s = max(longest_s, time.monotonic() - started_s)
        statuses[outcome.status] = statuses.get(outcome.status, 0) + 1
        if step == min(10, runs):
            before_kb = _memory_kb(made)
    return longest_s, statuses, _memory_kb(made) - before_kb


def _memory_kb(made: Harness) -> int:
    assert made.middleware is not None
    status = Path(f"/proc/{made.middleware.pid}/status").read_text()
    return int(status.partition("VmRSS:")[2].split()[0])


async def _serve_wrongly(bus: Bus, made: Harness, name: str) -> None:
    """An adapter in this process, on the bare bus."""
    keys, numbers = made.keys, {"sent": 0}

    async def flood() -> None:
        ends_s = time.monotonic() + TIMEOUT_S / 2
        while time.monotonic() < ends_s:
            for _ in range(100):
                numbers["sent"] += 1
                message = TopicMessage(numbers["sent"], {"data": numbers["sent"]})
                bus.tell(keys.topic("/level"), message)
            await asyncio.sleep(0.01)

    async def call(request: SkillCall, _: str) -> SkillResult:
        if name == "never replies":
            await asyncio.Event().wait()
        if name == "replies late":
            await asyncio.sleep(TIMEOUT_S + 0.3)
        if name == "floods its topic":
            await flood()
        if name == "replies for another id":
            return SkillResult(request.id.__class__("another", request.id.step), {})
        response = "whatever" if name == "unknown response" else ""
        return SkillResult(request.id, {}, {"/level": numbers["sent"]}, response)

    async def cancel(_: Cancel, __: str) -> Cancelled:
        return Cancelled()

    await bus.answer(keys.call("/skill"), SkillCall, call)
    if name == "replies twice":
        other = await Bus.open(made.endpoint, sender="twin")
        await other.answer(keys.call("/skill"), SkillCall, call)
    await bus.answer(keys.cancel("/skill"), Cancel, cancel)
    await bus.announce(keys.serve(Serving("wrong", "1", bus.instance, "/skill")))
