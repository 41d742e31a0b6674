"""The output that model code prints goes on to our error output, up to a limit: no loop of a document
fills a disk."""

import asyncio
from typing import BinaryIO

PRINT_LIMIT_BYTES = 1_000_000
"""An engine child may print this many bytes in its life."""

_CHUNK_BYTES = 65536


async def pass_on(printed: asyncio.StreamReader, out: BinaryIO) -> None:
    """Copies until the end. Past the limit all is read and dropped, so that the model never waits."""
    remaining_bytes = PRINT_LIMIT_BYTES
    while chunk := await printed.read(_CHUNK_BYTES):
        if remaining_bytes <= 0:
            continue
        out.write(chunk[:remaining_bytes])
        remaining_bytes -= len(chunk)
        if remaining_bytes <= 0:
            out.write(b"\naos: model code printed more than 1 MB; the rest is left out\n")
        out.flush()
