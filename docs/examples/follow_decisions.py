"""Follows a robot's decisions from the first step of its mission, whenever it is started.

python docs/examples/follow_decisions.py [RUN]
"""

import asyncio
import sys

from aos_runtime.client import AosClient


async def main(run: str = "runs/latest") -> None:
    async with AosClient.of_run(run) as aos:
        async for record in aos.decisions():
            if record.outcome is None:
                values = {action.action: round(action.q, 2) for action in record.actions}
                print(f"step {record.step}: {record.planner} chose {record.action}, of {values}")
            else:
                goal = record.belief.goal_probability
                print(f"step {record.step}: observed {record.outcome.response}, goal {goal:.3f}")


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
