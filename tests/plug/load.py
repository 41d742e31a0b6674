"""Two hundred skills declared, fifty topics at 100 Hz: does the middleware keep up, and at what cost?"""

import argparse
import asyncio
import time
from pathlib import Path

from aos_protocol.messages import TopicMessage

from .harness import Harness, harness, project_of

SKILLS = 200
TOPICS = 50
HERTZ = 100

WAITING = """
import asyncio
async def skill(call):
    await asyncio.sleep({seconds})
    return {{}}
"""


def _topic(number: int) -> str:
    return (
        f"local_variable: level_{number}\ntopic: /level_{number}\nmessage_type: Level\n"
        f"initial_value: 0\ncode:\nreturn __input.data\n"
    )


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seconds", type=float, default=10.0, metavar="S")


def measure(options: argparse.Namespace) -> int:
    """Prints the figures; 1 if messages were left behind."""
    return asyncio.run(_measure(options.seconds))


async def _measure(seconds: float) -> int:
    skills = {f"skill_{number}": "" for number in range(SKILLS)}
    skills["skill_0"] = "".join(_topic(number) for number in range(TOPICS))
    async with harness(project_of(skills)) as made:
        started_s = time.monotonic()
        bind = {f"/{name}": "skill" for name in skills}
        await made.adapter(WAITING.format(seconds=seconds), bind)
        await made.until_available(skills=SKILLS, timeout_s=120.0)
        print(f"{SKILLS} skills can be run after {time.monotonic() - started_s:.1f} s")
        running = asyncio.create_task(made.activate("skill_0", 1, seconds + 30))
        begun_s, before_s = time.monotonic(), _processor_s(made)
        sent = await _publish(made, seconds)
        ended_s = time.monotonic()
        outcome = await running
        lag_s, after_s = time.monotonic() - ended_s, _processor_s(made)
    last = [int(outcome.local_variables.get(f"level_{number}", 0)) for number in range(TOPICS)]
    share = (after_s - before_s) / (ended_s - begun_s)
    print(f"{sent * TOPICS} messages in {ended_s - begun_s:.1f} s, {sent / (ended_s - begun_s):.0f} Hz each")
    print(f"middleware with its worker: {share:.0%} of a core; answered {lag_s:.2f} s after the last message")
    print(f"newest message evaluated of each topic: {min(last)} to {max(last)} of {sent}; {outcome.status}")
    return int(outcome.status != "observed" or min(last) < 0.98 * sent)


async def _publish(made: Harness, seconds: float) -> int:
    """Publishes for some seconds and returns how many messages went on each topic."""
    ends_s, turn_s, sent = time.monotonic() + seconds, time.monotonic(), 0
    while time.monotonic() < ends_s:
        sent += 1
        for number in range(TOPICS):
            made.bus.tell(made.keys.topic(f"/level_{number}"), TopicMessage(sent, {"data": sent}))
        turn_s += 1 / HERTZ
        await asyncio.sleep(max(turn_s - time.monotonic(), 0))
    return sent


def _processor_s(made: Harness) -> float:
    """Returns the processor time of the middleware and everything below it."""
    assert made.middleware is not None
    return sum(_ticks(pid) for pid in _family(made.middleware.pid)) / 100


def _family(pid: int) -> list[int]:
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [pid, *(below for child in children for below in _family(int(child)))]


def _ticks(pid: int) -> int:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])
