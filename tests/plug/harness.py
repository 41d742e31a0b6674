"""Streams of processes that a campaign does not read."""

import asyncio


async def drained(stream: asyncio.StreamReader) -> None:
    """Returns at the end of a stream that nobody reads."""
    while await stream.read(2**16):
        pass
