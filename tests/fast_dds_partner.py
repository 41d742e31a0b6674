"""Talks over DDS with the program of another vendor: python tests/fast_dds_partner.py DOMAIN.

It ends with 0 if each heard the other. It is a process of its own, as an adapter is: what a process has
done with Cyclone DDS before changes what it finds.
"""

import asyncio
import sys
from collections.abc import AsyncIterator
from typing import Any

from aos_skills.dds.node import DdsNode
from aos_skills.ros.types import RosTypes

STRING = "std_msgs/msg/String"
DEADLINE_S = 120.0


async def talk(domain: int) -> None:
    """Raises AssertionError if the other program is not found or says something else, TimeoutError if
    nothing."""
    async with DdsNode(RosTypes(), domain=domain) as node:
        received: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
        found = await node.topic("/from_fast", DEADLINE_S)
        assert found is not None, "the other program's topic was not found"
        assert (found.type_name, found.qos.is_reliable) == (STRING, True)
        node.subscribe("/from_fast", STRING, received.put_nowait, found.qos)
        publish = node.publisher("/to_fast", STRING)
        # What is published before the two have found each other is lost.
        async for answer in answers(received):
            if answer is not None:
                assert answer == {"data": "LOUD"}
                return
            publish({"data": "loud"})


async def answers(received: asyncio.Queue[dict[str, Any]]) -> AsyncIterator[dict[str, Any] | None]:
    """Each answer as it comes, and None when there was none for a while."""
    async with asyncio.timeout(DEADLINE_S):
        while True:
            try:
                yield await asyncio.wait_for(received.get(), 0.05)
            except TimeoutError:
                yield None


if __name__ == "__main__":
    asyncio.run(talk(int(sys.argv[1])))
