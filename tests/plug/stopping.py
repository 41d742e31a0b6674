"""The time from the message that makes `stop_when` of a skill true to the cancellation, among many topics.

Each run draws when the message comes, and on which topic. The adapter sends it and is cancelled, so that one
clock measures both. All other topics go on at 100 Hz, from another process.
"""

import argparse
import asyncio
import json
import random
import statistics
import time
from collections.abc import Sequence

from aos_protocol.messages import TopicMessage

from .harness import Harness, harness, project_of

TOPICS = 20
HERTZ = 100
TARGET_S = 0.05

ROBOT = """
import asyncio, json, time

async def drive(call):
    plan = json.loads(open({plan!r}).read())
    await asyncio.sleep(plan["after_s"])
    call.publish(f"/level_{{plan['topic']}}", data=-1)
    sent_s = time.monotonic()
    try:
        await asyncio.sleep(5.0)
    finally:
        with open({times!r}, "a") as file:
            file.write(f"{{time.monotonic() - sent_s}}\\n")
    return {{}}
"""

STOP = f"stop_when: min({', '.join(f'level_{number}' for number in range(TOPICS))}) < 0\n"


def _topic(number: int) -> str:
    return (
        f"local_variable: level_{number}\ntopic: /level_{number}\nmessage_type: Level\n"
        f"initial_value: 0\ncode:\nreturn __input.data\n"
    )


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=500, metavar="N")
    parser.add_argument("--seed", type=int, default=1, metavar="N")


def measure(options: argparse.Namespace) -> int:
    """Prints the figures; 1 where a skill was not stopped, or the slowest hundredth took too long."""
    return asyncio.run(_measure(options.runs, random.Random(options.seed)))


async def _measure(runs: int, random_numbers: random.Random) -> int:
    mapping = STOP + "".join(_topic(number) for number in range(TOPICS))
    async with harness(project_of({"drive": mapping})) as made:
        plan, times = made.folder / "plan.json", made.folder / "times"
        await made.adapter(ROBOT.format(plan=str(plan), times=str(times)), {"/drive": "drive"})
        await made.until_available(skills=1)
        talking = asyncio.create_task(_talk(made))
        by = []
        for step in range(1, runs + 1):
            drawn = {"after_s": random_numbers.uniform(0.02, 0.3), "topic": random_numbers.randrange(TOPICS)}
            plan.write_text(json.dumps(drawn))
            outcome = await made.activate("drive", step)
            by.append(outcome.stopped_by)
        talking.cancel()
        taken_s = sorted(float(line) for line in times.read_text().split())
    return _print_figures(by, taken_s)


def _print_figures(by: Sequence[str], taken_s: Sequence[float]) -> int:
    p99_s = taken_s[min(len(taken_s) - 1, int(0.99 * len(taken_s)))]
    print(f"{by.count('drive')} of {len(by)} skills were stopped, {TOPICS} topics at {HERTZ} Hz")
    print(
        f"from the message to the cancellation: median {1e3 * statistics.median(taken_s):.1f} ms, "
        f"p99 {1e3 * p99_s:.1f} ms, at most {1e3 * taken_s[-1]:.1f} ms"
    )
    return int(by.count("drive") < len(by) or p99_s > TARGET_S)


async def _talk(made: Harness) -> None:
    """Sends on all topics at their frequency."""
    turn_s, sent = time.monotonic(), 0
    while True:
        sent += 1
        for number in range(TOPICS):
            made.bus.tell(made.keys.topic(f"/level_{number}"), TopicMessage(sent, {"data": sent}))
        turn_s += 1 / HERTZ
        await asyncio.sleep(max(turn_s - time.monotonic(), 0))
