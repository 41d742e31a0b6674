"""Follows a robot's decisions from the first step of its mission, whenever it is started.

python docs/examples/follow_decisions.py [RUN]
"""

import asyncio
import signal
import sys

from aos_protocol.errors import AosError
from aos_runtime.client import AosClient


async def main(run: str = "runs/latest") -> None:
    async with AosClient.of_run(run) as aos:
        async for record in aos.decisions():
            if record.outcome is None:
                values = ", ".join(f"{action.action} {action.q:+.2f}" for action in record.actions)
                # An action that an operator has asked for was compared with no other.
                why = f", {record.planner}, of {values}" if values else ""
                print(f"step {record.step}: {record.chosen_by} chose {record.action}{why}")
            else:
                told = record.outcome.response or f"nothing ({record.outcome.status})"
                print(f"step {record.step}: observed {told}, goal {record.belief.goal_probability:.3f}")


if __name__ == "__main__":
    for ending in (signal.SIGINT, signal.SIGPIPE):  # Ctrl-C, and a reader such as `head` that has enough.
        signal.signal(ending, signal.SIG_DFL)
    try:
        asyncio.run(main(*sys.argv[1:]))
    except AosError as error:
        sys.exit(str(error))
